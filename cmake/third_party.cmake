# The third-party libraries (all Debian 12 packages), one INTERFACE target each, named third_party_<name>.
# slamd_third_party(NAME HEADERS h...) also writes tripwire headers: whoever includes one of HEADERS without
# declaring NAME gets an #error that names both (see slamd_targets.cmake).
set(SLAMD_THIRD_PARTY "")

function(slamd_third_party name)
  cmake_parse_arguments(arg "" "" "TRIPWIRES;LIBRARIES;INCLUDES" ${ARGN})
  add_library(third_party_${name} INTERFACE)
  target_link_libraries(third_party_${name} INTERFACE ${arg_LIBRARIES})
  target_include_directories(third_party_${name} SYSTEM INTERFACE ${arg_INCLUDES})
  set(root ${PROJECT_BINARY_DIR}/tripwire/${name})
  file(MAKE_DIRECTORY ${root})
  foreach(header IN LISTS arg_TRIPWIRES)
    file(CONFIGURE OUTPUT ${root}/${header} CONTENT
      "#error \"<${header}> needs ${name} among the DEPS of this target (CMakeLists.txt of its folder)\"\n")
  endforeach()
  set(SLAMD_THIRD_PARTY ${SLAMD_THIRD_PARTY} ${name} PARENT_SCOPE)
endfunction()

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(spdlog REQUIRED)
find_package(PNG REQUIRED)
find_path(NLOHMANN_JSON_INCLUDE nlohmann/json.hpp REQUIRED)
find_path(PCAP_INCLUDE pcap/pcap.h REQUIRED)
find_library(PCAP_LIBRARY pcap REQUIRED)

slamd_third_party(eigen LIBRARIES Eigen3::Eigen)
slamd_third_party(threads LIBRARIES Threads::Threads)
slamd_third_party(tomlplusplus LIBRARIES tomlplusplus::tomlplusplus TRIPWIRES toml++/toml.h)
slamd_third_party(cli11 LIBRARIES CLI11::CLI11 TRIPWIRES CLI/CLI.hpp)
slamd_third_party(spdlog LIBRARIES spdlog::spdlog TRIPWIRES spdlog/spdlog.h)
slamd_third_party(nlohmann_json INCLUDES ${NLOHMANN_JSON_INCLUDE} TRIPWIRES nlohmann/json.hpp)
slamd_third_party(png LIBRARIES PNG::PNG TRIPWIRES png.h)
slamd_third_party(pcap LIBRARIES ${PCAP_LIBRARY} INCLUDES ${PCAP_INCLUDE} TRIPWIRES pcap.h pcap/pcap.h)

if(SLAMD_BUILD_TESTS)
  find_package(GTest REQUIRED)
  find_package(rapidcheck REQUIRED)
  slamd_third_party(gtest_main LIBRARIES GTest::gtest_main GTest::gmock
    TRIPWIRES gtest/gtest.h gmock/gmock.h)
  slamd_third_party(rapidcheck LIBRARIES rapidcheck TRIPWIRES rapidcheck.h rapidcheck/gtest.h)
endif()
find_package(benchmark QUIET)
if(benchmark_FOUND)
  slamd_third_party(benchmark LIBRARIES benchmark::benchmark TRIPWIRES benchmark/benchmark.h)
endif()
