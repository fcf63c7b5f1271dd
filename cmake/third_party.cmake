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
# Debian's liblcm-dev has no CMake package, and its lcm.pc asks for glib's headers, which nobody needs.
find_path(LCM_INCLUDE lcm/lcm.h REQUIRED)
find_library(LCM_LIBRARY lcm REQUIRED)
find_path(GEOGRAPHICLIB_INCLUDE GeographicLib/LocalCartesian.hpp REQUIRED)
find_library(GEOGRAPHICLIB_LIBRARY NAMES GeographicLib Geographic REQUIRED)

slamd_third_party(eigen LIBRARIES Eigen3::Eigen)
slamd_third_party(threads LIBRARIES Threads::Threads)
slamd_third_party(tomlplusplus LIBRARIES tomlplusplus::tomlplusplus TRIPWIRES toml++/toml.h)
slamd_third_party(cli11 LIBRARIES CLI11::CLI11 TRIPWIRES CLI/CLI.hpp)
slamd_third_party(spdlog LIBRARIES spdlog::spdlog TRIPWIRES spdlog/spdlog.h)
slamd_third_party(nlohmann_json INCLUDES ${NLOHMANN_JSON_INCLUDE} TRIPWIRES nlohmann/json.hpp)
slamd_third_party(png LIBRARIES PNG::PNG TRIPWIRES png.h)
slamd_third_party(pcap LIBRARIES ${PCAP_LIBRARY} INCLUDES ${PCAP_INCLUDE} TRIPWIRES pcap.h pcap/pcap.h)
slamd_third_party(geographiclib LIBRARIES ${GEOGRAPHICLIB_LIBRARY} INCLUDES ${GEOGRAPHICLIB_INCLUDE}
  TRIPWIRES GeographicLib/LocalCartesian.hpp)
slamd_third_party(lcm LIBRARIES ${LCM_LIBRARY} INCLUDES ${LCM_INCLUDE} TRIPWIRES lcm/lcm.h lcm/lcm-cpp.hpp)

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

# Optional: reading ROS 1 bags. Debian 12 pairs it with ROS 2's pluginlib, which is why there are so many roots.
if(SLAMD_WITH_ROSBAG)
  find_path(ROSBAG_INCLUDE rosbag/bag.h)
  set(rosbag_parts ${ROSBAG_INCLUDE})
  foreach(part pluginlib/class_loader class_loader/class_loader rcpputils/shared_library
               ament_index_cpp/get_resource rcutils/shared_library)
    get_filename_component(package ${part} DIRECTORY)
    find_path(ROSBAG_${package}_INCLUDE NAMES ${part}.hpp ${part}.h PATH_SUFFIXES ${package})
    list(APPEND rosbag_parts ${ROSBAG_${package}_INCLUDE})
  endforeach()
  foreach(library rosbag_storage rostime roscpp_serialization cpp_common console_bridge class_loader
                  ament_index_cpp rcpputils rcutils tinyxml2)
    find_library(ROSBAG_${library}_LIBRARY ${library})
    list(APPEND rosbag_parts ${ROSBAG_${library}_LIBRARY})
    list(APPEND rosbag_libraries ${ROSBAG_${library}_LIBRARY})
  endforeach()
  if(rosbag_parts MATCHES "NOTFOUND")
    message(STATUS "ROS bags: not found (librosbag-storage-dev); slamd-import is built without them")
  else()
    slamd_third_party(rosbag LIBRARIES ${rosbag_libraries}
      INCLUDES ${ROSBAG_INCLUDE} ${ROSBAG_pluginlib_INCLUDE} ${ROSBAG_class_loader_INCLUDE}
               ${ROSBAG_rcpputils_INCLUDE} ${ROSBAG_ament_index_cpp_INCLUDE} ${ROSBAG_rcutils_INCLUDE}
      TRIPWIRES rosbag/bag.h rosbag/view.h)
  endif()
endif()

# Optional: what slamd-bench compares its neighbour search with (tools/setup --bench). PCL's own CMake package asks for
# all that PCL can use; its kd-tree needs two of its libraries.
find_path(PCL_INCLUDE pcl/kdtree/kdtree_flann.h PATH_SUFFIXES pcl-1.13 pcl-1.14 pcl-1.15)
find_path(FLANN_INCLUDE flann/flann.hpp)
find_path(NANOFLANN_INCLUDE nanoflann.hpp)
foreach(library pcl_kdtree pcl_common flann_cpp)
  find_library(PEER_${library}_LIBRARY ${library})
endforeach()
set(peer_parts ${PCL_INCLUDE} ${FLANN_INCLUDE} ${PEER_pcl_kdtree_LIBRARY} ${PEER_pcl_common_LIBRARY}
  ${PEER_flann_cpp_LIBRARY} ${NANOFLANN_INCLUDE})
if(peer_parts MATCHES "NOTFOUND" OR CMAKE_CROSSCOMPILING)
  message(STATUS "PCL and nanoflann: not found (tools/setup --bench); slamd-bench compares its search with nothing")
else()
  slamd_third_party(pcl_kdtree LIBRARIES ${PEER_pcl_kdtree_LIBRARY} ${PEER_pcl_common_LIBRARY} ${PEER_flann_cpp_LIBRARY}
    lz4 INCLUDES ${PCL_INCLUDE} ${FLANN_INCLUDE} TRIPWIRES pcl/kdtree/kdtree_flann.h)
  slamd_third_party(nanoflann INCLUDES ${NANOFLANN_INCLUDE} TRIPWIRES nanoflann.hpp)
endif()

# Optional: what the factor graph's optimum is held against in tests and in slamd-bench. Nothing that is shipped links it.
# Ceres's own CMake package asks for all that it was built with; its headers need glog's alone.
find_path(CERES_INCLUDE ceres/ceres.h)
find_path(GLOG_INCLUDE glog/logging.h)
find_library(CERES_LIBRARY ceres)
find_library(GLOG_LIBRARY glog)
set(ceres_parts ${CERES_INCLUDE} ${GLOG_INCLUDE} ${CERES_LIBRARY} ${GLOG_LIBRARY})
if(ceres_parts MATCHES "NOTFOUND" OR CMAKE_CROSSCOMPILING)
  message(STATUS "Ceres: not found (libceres-dev); the factor graph is compared with nothing")
else()
  slamd_third_party(ceres LIBRARIES ${CERES_LIBRARY} ${GLOG_LIBRARY} INCLUDES ${CERES_INCLUDE} ${GLOG_INCLUDE}
    TRIPWIRES ceres/ceres.h ceres/rotation.h)
endif()
