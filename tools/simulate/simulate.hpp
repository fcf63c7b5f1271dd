#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/simulate/scene.hpp"
#include "tools/simulate/text_file.hpp"

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

// What a drive that is simulated otherwise shares with it.

/// imu.csv. Errors: RecordingError.
class ImuFile {
 public:
  explicit ImuFile(const std::filesystem::path& file);

  void write(const sensor::ImuSample& sample, double temp_c);
  void close() { out_.close(); }

 private:
  TextFile out_;
};

/// Writes recording.toml and simulation.json.
void write_parameters(const Drive& drive, const std::filesystem::path& directory);

/// Writes what follows from the motion alone: truth.tum, loops.csv, odom.csv, gnss.csv, perhaps true_map.ply.
void write_surroundings(const Scene& scene, const std::filesystem::path& directory);

}  // namespace slamd::simulate
