# slamd_lcm_types(FOLDER FILES f.lcm...): a library of the C++ types that lcm-gen makes of the folder's files at build time.
# It stands in for the lcm_wrap_types() that Debian's liblcm-dev lacks. Its headers, <build>/lcm/<package>/<type>.hpp, are
# in an include root of their own, which counts as a system's: they are not ours to warn about. A cross build runs the
# lcm-gen of the machine that builds.
find_program(LCM_GEN lcm-gen REQUIRED)

function(slamd_lcm_types folder)
  cmake_parse_arguments(arg "" "" "FILES" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "slamd_lcm_types(${folder}): unexpected ${arg_UNPARSED_ARGUMENTS}")
  endif()
  _slamd_target_name(name ${folder})
  set(root ${PROJECT_BINARY_DIR}/lcm)
  set(headers "")
  foreach(file IN LISTS arg_FILES)
    set(source ${PROJECT_SOURCE_DIR}/${folder}/${file})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})  # its types name the headers
    file(STRINGS ${source} lines REGEX "^(package|struct) ")
    set(package "")
    set(own_headers "")
    foreach(line IN LISTS lines)
      if(line MATCHES "^package +([A-Za-z0-9_]+)")
        set(package ${CMAKE_MATCH_1})
      elseif(line MATCHES "^struct +([A-Za-z0-9_]+)")
        list(APPEND own_headers ${root}/${package}/${CMAKE_MATCH_1}.hpp)
      endif()
    endforeach()
    if(package STREQUAL "" OR own_headers STREQUAL "")
      message(FATAL_ERROR "slamd_lcm_types(${folder}): no package or no struct at the beginning of a line of ${file}")
    endif()
    add_custom_command(OUTPUT ${own_headers}
      COMMAND ${LCM_GEN} --cpp --cpp-std c++11 --cpp-hpath ${root} ${source}
      DEPENDS ${source} COMMENT "lcm-gen ${folder}/${file}" VERBATIM)
    list(APPEND headers ${own_headers})
  endforeach()
  add_custom_target(${name}_headers DEPENDS ${headers})
  add_library(${name} INTERFACE)
  add_dependencies(${name} ${name}_headers)
  target_include_directories(${name} SYSTEM INTERFACE ${root})
  _slamd_link(${name} INTERFACE "lcm")
endfunction()
