# cmake --install: programs, manual, completion, configuration and what systemd and udev are told. The Debian packages
# (debian/, tools/package) hold the same. Components: service, and tools for work on recordings. slamd-bench stays where it is
# built: it measures this tree.
include(GNUInstallDirs)
set(SLAMD_SYSCONFDIR /etc CACHE PATH "Where slamd/slamd.toml is installed, and the service looks for it")

install(TARGETS slamd slamd-ctl slamd-status slamd-sensors COMPONENT service)
install(TARGETS slamd-replay slamd-evaluate slamd-simulate slamd-import slamd-map COMPONENT tools)

# slamd_manual(COMPONENT PROGRAM PAGE [OPTION...]): the page, of what the built program says of itself.
function(slamd_manual component program page)
  set(written ${PROJECT_BINARY_DIR}/manual/${page})
  add_custom_command(OUTPUT ${written}
    COMMAND ${PROJECT_SOURCE_DIR}/tools/man_page ${ARGN} ${page} ${PROJECT_VERSION} ${CMAKE_CROSSCOMPILING_EMULATOR}
            $<TARGET_FILE:${program}> > ${written}
    DEPENDS ${program} ${PROJECT_SOURCE_DIR}/tools/man_page ${PROJECT_SOURCE_DIR}/docs/manual/${page}
    VERBATIM)
  set_property(GLOBAL APPEND PROPERTY SLAMD_MANUAL ${written})
  string(REGEX MATCH "[0-9]$" section ${page})
  install(FILES ${written} DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section} COMPONENT ${component} OPTIONAL)
endfunction()

file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/manual)
slamd_manual(service slamd slamd.8)
slamd_manual(service slamd-replay slamd.toml.5 --keys)
foreach(program slamd-ctl slamd-status slamd-sensors)
  slamd_manual(service ${program} ${program}.1)
endforeach()
foreach(program slamd-replay slamd-evaluate slamd-simulate slamd-import slamd-map)
  slamd_manual(tools ${program} ${program}.1)
endforeach()
# `cmake --build ... --target installable`: all that is installed, and no test.
get_property(pages GLOBAL PROPERTY SLAMD_MANUAL)
add_custom_target(installable DEPENDS ${pages})

set(completions ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
foreach(program slamd slamd-ctl slamd-status slamd-sensors slamd-replay slamd-evaluate slamd-simulate slamd-import slamd-map)
  set(component service)
  if(program MATCHES "replay|evaluate|simulate|import|map")
    set(component tools)
  endif()
  install(FILES systemd/slamd.bash DESTINATION ${completions} RENAME ${program} COMPONENT ${component})
endforeach()

install(FILES systemd/slamd.toml DESTINATION ${SLAMD_SYSCONFDIR}/slamd COMPONENT service)
# Where the programs are is known only when they are installed.
install(CODE "
  file(READ \"${PROJECT_SOURCE_DIR}/systemd/slamd.service\" unit)
  string(REPLACE /usr/bin/slamd \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/slamd\" unit \"\${unit}\")
  string(REPLACE /etc/slamd \"${SLAMD_SYSCONFDIR}/slamd\" unit \"\${unit}\")
  file(WRITE \"${PROJECT_BINARY_DIR}/manual/slamd.service\" \"\${unit}\")" COMPONENT service)
install(FILES ${PROJECT_BINARY_DIR}/manual/slamd.service DESTINATION lib/systemd/system COMPONENT service)
install(FILES systemd/slamd.sysusers DESTINATION lib/sysusers.d RENAME slamd.conf COMPONENT service)
install(FILES systemd/slamd.tmpfiles DESTINATION lib/tmpfiles.d RENAME slamd.conf COMPONENT service)
install(FILES systemd/60-slamd.rules DESTINATION lib/udev/rules.d COMPONENT service)
