#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

namespace slamd::simulate {

enum class LidarKind { kVlp16, kLivoxAvia };

/// What is to be simulated.
struct Drive {
  LidarKind lidar = LidarKind::kVlp16;
  std::uint64_t seed = 1;
  double duration_s = 60.0;
  double speed_mps = 1.6;
  double rest_s = 3.0;       // standing still at the start
  double imu_rate_hz = 200.0;
  int threads = 2;           // of the ray casting; the bytes are the same for any number
};

/// What was made.
struct Summary {
  std::uint64_t packets = 0;
  std::uint64_t rays = 0;
  double path_m = 0.0;
};

/// Simulates a drive through the town of its seed and writes a recording: lidar.pcap, imu.csv, truth.tum (base in
/// world, 100 Hz), recording.toml and simulation.json with every parameter.
/// The time base is Unix time from a fixed moment on; the same seed gives the same bytes.
/// Errors: RecordingError, std::runtime_error.
Summary simulate(const Drive& drive, const std::filesystem::path& directory, const std::function<void(double)>& progress);

}  // namespace slamd::simulate
