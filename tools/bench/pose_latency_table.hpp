#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/stamp.hpp"

namespace slamd::bench {

/// A moment of one inertial sample or its pose, told apart by its stamp.  Units: instant is CLOCK_MONOTONIC.
struct Moment {
  Stamp stamp{};
  Duration instant{};
};

/// What one condition of the pose latency benchmark gave.
struct PoseLatencyRow {
  int hogs = 0;               // programs that only compute, under SCHED_OTHER
  bool fifo = false;          // daemon and subscriber under SCHED_FIFO
  std::uint64_t sent = 0;     // inertial samples since the first pose
  std::uint64_t heard = 0;    // poses of these
  Duration p50{};
  Duration p99{};
  Duration p999{};
  Duration max{};

  double delivered() const { return sent == 0 ? 0.0 : static_cast<double>(heard) / static_cast<double>(sent); }
};

/// Matches the poses heard with the samples sent. Samples before the first pose are the daemon's start and do not count;
/// a pose that is heard twice, or for no sample, counts once or not at all.
/// `sent` is in the order of the stamps.
PoseLatencyRow row_of(std::span<const Moment> sent, std::span<const Moment> heard);

/// One table, with ratios to its first row.
std::string table_of(const std::vector<PoseLatencyRow>& rows);

std::string json_of(const std::vector<PoseLatencyRow>& rows, std::size_t pose_bytes, double imu_rate_hz);

}  // namespace slamd::bench
