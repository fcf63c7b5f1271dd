#pragma once

#include "core/base/latest.hpp"
#include "daemon/bus/publisher.hpp"
#include "daemon/pipeline/rings.hpp"
#include "daemon/stages/occupancy_stage.hpp"
#include "daemon/threads/stage_monitor.hpp"
#include "drivers/transport/host_clock.hpp"

namespace slamd::pipeline {

/// What the occupancy thread shows.
struct OccupancyCounts {
  std::uint64_t scans = 0;
  std::uint64_t changes = 0;  // messages sent, by kind
  std::uint64_t keys = 0;
  std::uint64_t repairs = 0;
};

/// The occupancy thread: carves each scan into the grid around the robot and sends what has changed, key blocks and what
/// clients have asked for. Not a real-time one, for it sends many messages; no other thread ever waits for it. When it is
/// late publish finds no free buffer and lets the scan go, counted there.
/// Threads: run_once() by one; counts() by any.
class OccupancyLoop {
 public:
  OccupancyLoop(const occupancy::GridConfig& config, const transport::HostClock& clock, Rings& rings, bus::Publisher& publisher);

  /// Sleeps until there is a scan, at most `longest`, takes it in and sends what is due.
  void run_once(Duration longest);

  OccupancyCounts counts() const { return shown_.load().value_or(OccupancyCounts{}); }
  const threads::StageMonitor& monitor() const { return monitor_; }  // of carving alone

 private:
  void tell(Stamp now);

  transport::HostClock clock_;
  Rings& rings_;
  bus::Publisher& publisher_;
  stages::OccupancyStage stage_;
  OccupancyCounts counts_;
  Stamp told_{};
  // Written by the occupancy thread, read by health.
  Latest<OccupancyCounts> shown_;
  threads::StageMonitor monitor_;
};

}  // namespace slamd::pipeline
