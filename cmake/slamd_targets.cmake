# One library per folder; the compiler enforces the layers.
#
# Each library has an include root of its own, <build>/include/<name>, which holds nothing but a link to its
# folder. A target sees the roots of its DEPS only, so an undeclared include is "No such file or directory".
# Debian's third-party headers share /usr/include; a target therefore also gets, in front of everything
# else, a root of tripwire headers (#error) for each third-party library that it does not declare.

# The one place for compiler flags.
add_library(slamd_flags INTERFACE)
target_compile_options(slamd_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual -Wundef
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # g++ 12 sees overlaps in std::string sums that cannot be
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>  # g++ 12 sees it in every Eigen matrix that is filled after its declaration
  # ... and, once libstdc++ is precompiled and no longer silenced as a system's header, more of that kind.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${SLAMD_PRECOMPILED_HEADERS}>>:-Wno-stringop-overflow;-Wno-array-bounds>
  -ffp-contract=off  # the same sums on every machine, with FMA or without
  $<$<BOOL:${SLAMD_WARNINGS_AS_ERRORS}>:-Werror>)

# With SLAMD_PRECOMPILED_HEADERS each source begins with the heavy headers below, parsed once: a third less to compile.
# The presets dev and fuzz do without, so that there each source names what it uses.
set(SLAMD_HEAVY_HEADERS <algorithm> <array> <chrono> <cmath> <filesystem> <fstream> <functional> <memory> <optional> <random>
  <span> <string> <vector> <Eigen/Core> <Eigen/Geometry> <Eigen/Cholesky>)

# The tests themselves are compiled quickly, whatever they test at full optimisation.
set(SLAMD_TEST_OPTIMISATION $<$<CONFIG:Release>:-O1>)

# Gives TARGET the headers that the first target of that KIND (library or test) has parsed.
function(_slamd_precompile target kind)
  if(NOT SLAMD_PRECOMPILED_HEADERS)
    return()
  endif()
  set(parsed slamd_${kind}_headers)
  if(NOT TARGET ${parsed})
    file(WRITE ${PROJECT_BINARY_DIR}/${parsed}.cpp "")
    add_library(${parsed} OBJECT ${PROJECT_BINARY_DIR}/${parsed}.cpp)
    target_link_libraries(${parsed} PRIVATE slamd_flags third_party_eigen third_party_threads)
    set(headers ${SLAMD_HEAVY_HEADERS})
    if(kind STREQUAL "test")
      target_link_libraries(${parsed} PRIVATE third_party_gtest_main)
      target_compile_options(${parsed} PRIVATE ${SLAMD_TEST_OPTIMISATION})
      list(APPEND headers <gtest/gtest.h>)
    endif()
    target_precompile_headers(${parsed} PRIVATE ${headers})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${parsed})
endfunction()

# With SLAMD_UNITY_BUILD a folder's sources are compiled some at a time, as if they were one: what they include is parsed once,
# and a build of everything takes half as long. Names of one source's unnamed namespace then meet those of the next; where
# they must not, ALONE names the source. The presets dev, tidy and fuzz do without, so that there each source stands alone.
function(_slamd_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SLAMD_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE 16)
  if(ARGN)
    set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endfunction()

function(_slamd_target_name out folder)
  string(REPLACE "/" "_" name ${folder})
  set(${out} slamd_${name} PARENT_SCOPE)
endfunction()

# Links DEPS (folders such as core/base, or third-party names such as eigen) and sets the tripwires.
function(_slamd_link target visibility deps)
  set(undeclared ${SLAMD_THIRD_PARTY})
  foreach(dep IN LISTS deps)
    if(dep IN_LIST SLAMD_THIRD_PARTY)
      list(REMOVE_ITEM undeclared ${dep})
      target_link_libraries(${target} ${visibility} third_party_${dep})
    else()
      _slamd_target_name(name ${dep})
      target_link_libraries(${target} ${visibility} ${name})
      get_property(inherited GLOBAL PROPERTY SLAMD_THIRD_PARTY_OF_${name})
      foreach(item IN LISTS inherited)
        list(REMOVE_ITEM undeclared ${item})
      endforeach()
    endif()
  endforeach()
  set(declared ${SLAMD_THIRD_PARTY})
  foreach(item IN LISTS undeclared)
    list(REMOVE_ITEM declared ${item})
  endforeach()
  set_property(GLOBAL PROPERTY SLAMD_THIRD_PARTY_OF_${target} "${declared}")
  if(NOT visibility STREQUAL "INTERFACE")
    foreach(item IN LISTS undeclared)
      target_include_directories(${target} BEFORE PRIVATE ${PROJECT_BINARY_DIR}/tripwire/${item})
    endforeach()
  endif()
endfunction()

# slamd_library(FOLDER [HEADERS h...] [SOURCES s...] [DEPS d...]): without SOURCES a header-only library.
function(slamd_library folder)
  cmake_parse_arguments(arg "" "" "HEADERS;SOURCES;DEPS" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "slamd_library(${folder}): unexpected ${arg_UNPARSED_ARGUMENTS}")
  endif()
  _slamd_target_name(name ${folder})
  set(root ${PROJECT_BINARY_DIR}/include/${name})
  get_filename_component(parent ${root}/${folder} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${root}/${folder} SYMBOLIC)
  list(TRANSFORM arg_HEADERS PREPEND ${root}/${folder}/)
  list(TRANSFORM arg_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/${folder}/)
  if(arg_SOURCES)
    add_library(${name} STATIC ${arg_SOURCES})
    _slamd_unity(${name})
    set(visibility PUBLIC)
    target_link_libraries(${name} PRIVATE slamd_flags)
  else()
    add_library(${name} INTERFACE)
    set(visibility INTERFACE)
  endif()
  if(arg_HEADERS)
    target_sources(${name} ${visibility} FILE_SET HEADERS BASE_DIRS ${root} FILES ${arg_HEADERS})
    # `cmake --build ... --target all_verify_interface_header_sets` proves that each header compiles alone.
    set_target_properties(${name} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
  endif()
  _slamd_link(${name} ${visibility} "${arg_DEPS}")
  if(arg_SOURCES)
    _slamd_precompile(${name} library)
  endif()
endfunction()

# slamd_program(NAME FOLDER SOURCES s... [DEPS d...]): a program in <build>/bin.
function(slamd_program program folder)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS" ${ARGN})
  list(TRANSFORM arg_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/${folder}/)
  add_executable(${program} ${arg_SOURCES})
  _slamd_unity(${program})
  target_link_libraries(${program} PRIVATE slamd_flags)
  _slamd_link(${program} PRIVATE "${arg_DEPS}")
  _slamd_precompile(${program} library)
endfunction()

# slamd_preload(NAME FOLDER SOURCES s... [DEPS d...]): <build>/lib/lib<NAME>.so, for LD_PRELOAD: what watches or changes a
# program from outside while it is measured. Nothing that is shipped links it.
function(slamd_preload name folder)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS" ${ARGN})
  list(TRANSFORM arg_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/${folder}/)
  add_library(${name} MODULE ${arg_SOURCES})
  set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
  target_link_libraries(${name} PRIVATE slamd_flags ${CMAKE_DL_LIBS})
  _slamd_link(${name} PRIVATE "${arg_DEPS}")
endfunction()

# slamd_test(FOLDER SOURCES s... [ALONE s...] [DEPS d...] [LABELS l...]): the tests of one folder, as one program.
# It sees only what the folder's own DEPS list, the folder itself and gtest. Labels: "threads" marks what the
# ThreadSanitizer run repeats; the target "threaded_tests" builds just those. "sockets" marks what needs a real
# kernel's sockets, "long" what simulates drives: neither is run in the emulator. The target "onboard_tests" builds those of
# the folders that run on a vehicle, core, drivers and daemon, that the emulator runs; "onboard_socket_tests" the others.
function(slamd_test folder)
  cmake_parse_arguments(arg "" "" "SOURCES;ALONE;DEPS;LABELS" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "slamd_test(${folder}): unexpected ${arg_UNPARSED_ARGUMENTS}")
  endif()
  string(REPLACE "/" "_" name ${folder})
  set(name test_${name})
  list(TRANSFORM arg_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/tests/${folder}/)
  list(TRANSFORM arg_ALONE PREPEND ${PROJECT_SOURCE_DIR}/tests/${folder}/)
  add_executable(${name} ${arg_SOURCES} ${arg_ALONE})
  _slamd_unity(${name} ${arg_ALONE})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE slamd_flags)
  target_compile_options(${name} PRIVATE ${SLAMD_TEST_OPTIMISATION})
  target_compile_definitions(${name} PRIVATE
    SLAMD_SHARED_DATA_DIR="${PROJECT_SOURCE_DIR}/../shared/data"
    SLAMD_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    SLAMD_BINARY_DIR="${PROJECT_BINARY_DIR}")
  _slamd_link(${name} PRIVATE "gtest_main;${arg_DEPS}")
  _slamd_precompile(${name} test)
  add_test(NAME ${folder} COMMAND ${name})
  set_tests_properties(${folder} PROPERTIES LABELS "${arg_LABELS}")
  if("threads" IN_LIST arg_LABELS)
    if(NOT TARGET threaded_tests)
      add_custom_target(threaded_tests)
    endif()
    add_dependencies(threaded_tests ${name})
  endif()
  if(folder MATCHES "^(core|daemon|drivers)/" AND NOT "long" IN_LIST arg_LABELS)
    set(onboard onboard_tests)
    if("sockets" IN_LIST arg_LABELS)
      set(onboard onboard_socket_tests)
    endif()
    if(NOT TARGET ${onboard})
      add_custom_target(${onboard})
    endif()
    add_dependencies(${onboard} ${name})
  endif()
endfunction()

# slamd_fuzzer(NAME SOURCES s... [DEPS d...]): a libFuzzer program in <build>/fuzz, built by the target "fuzzers".
function(slamd_fuzzer name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS" ${ARGN})
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "slamd_fuzzer(${name}): unexpected ${arg_UNPARSED_ARGUMENTS}")
  endif()
  set(program fuzz_${name})
  list(TRANSFORM arg_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/tests/fuzz/)
  add_executable(${program} ${arg_SOURCES})
  set_target_properties(${program} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/fuzz)
  target_link_libraries(${program} PRIVATE slamd_flags)
  target_link_options(${program} PRIVATE -fsanitize=fuzzer)
  _slamd_link(${program} PRIVATE "${arg_DEPS}")
  if(NOT TARGET fuzzers)
    add_custom_target(fuzzers)
  endif()
  add_dependencies(fuzzers ${program})
endfunction()
