#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/simulate/drive.hpp"

namespace slamd::simulate {

/// What was made.
struct Summary {
  std::uint64_t packets = 0;
  std::uint64_t rays = 0;
  double path_m = 0.0;
};

/// Simulates a drive and writes a recording: lidar.pcap, imu.csv, odom.csv, gnss.csv, truth.tum (base in world, 100
/// Hz), loops.csv (true revisits), recording.toml and simulation.json with every parameter; with drive.map also
/// true_map.ply. Nothing of the drive's length is kept in memory but its path.
/// The time base is Unix time from a fixed moment on; the same seed gives the same bytes.
/// Errors: RecordingError, std::runtime_error.
Summary simulate(const Drive& drive, const std::filesystem::path& directory,
                 const std::function<void(double)>& progress);

}  // namespace slamd::simulate
