#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "tools/bench/pose_latency_table.hpp"

namespace slamd::bench {

/// How the latency of poses is measured.
struct PoseLatencyConfig {
  std::filesystem::path slamd;    // the program
  std::filesystem::path padding;  // libslamd_padded_pose.so
  double seconds = 25.0;          // a row
  double imu_rate_hz = 400.0;
  std::size_t pose_bytes = 1024;  // of a pose message, at most 1,400; fewer than its own: as it is
  int hogs = 4;
};

/// Measures from the sending of an inertial sample to the moment when a subscriber has its pose in hand: quiet and
/// beside hogs, under SCHED_FIFO and SCHED_OTHER, four rows.
///
/// The daemon is the real one, in a process of its own; it maps a simulated drive whose VLP-16 packets and inertial rows
/// this program sends over loopback with their timing, from a thread that comes before all others, as an interface card
/// does. Rows carry stamps of the daemon's time base, by which poses are matched with them. On loopback a datagram has
/// arrived when sendto() returns; the clock is read before.
/// Errors: std::runtime_error; std::system_error.
std::vector<PoseLatencyRow> measure_pose_latency(const PoseLatencyConfig& config, const std::function<void(double share)>& progress);

}  // namespace slamd::bench
