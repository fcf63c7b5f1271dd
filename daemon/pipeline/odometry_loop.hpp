#pragma once

#include "core/base/latest.hpp"
#include "daemon/pipeline/rings.hpp"
#include "daemon/threads/event_ring.hpp"
#include "daemon/threads/stage_monitor.hpp"
#include "drivers/transport/host_clock.hpp"

namespace slamd::pipeline {

/// What the odometry thread shows.
struct OdometryCounts {
  std::uint64_t scans = 0;
  std::uint64_t skipped = 0;        // let pass, for a newer one was there
  std::uint64_t recoveries = 0;     // recovery swarms
  std::uint64_t swarm_won = 0;
  std::uint64_t map_recycled = 0;   // cells
  std::uint64_t wheels_used = 0;    // samples of the wheels
  std::uint64_t wheels_slipped = 0;
  std::uint32_t map_cells = 0;
  std::uint32_t particles = 0;      // of the last scan
  odometry::State state = odometry::State::kStarting;
  odometry::Cause cause = odometry::Cause::kAligning;
  std::uint8_t weak_axes = 0;
  std::uint8_t weak_axes_base = 0;
  double inlier_ratio = 0.0;
  calibration::SensorAgreement agreement;  // of a scan in ten
  Stamp last{};                     // end of the last scan
  std::uint32_t epoch = 0;          // of the last scan's odom; 0: none yet
};

/// The odometry thread: features to poses.
/// When late it takes the newest scan and lets the older ones pass, counted.
/// Threads: run_once() by one; counts() by any.  Real-time: allocates in the constructor only; sleeps in one WakeUp.
class OdometryLoop {
 public:
  OdometryLoop(const odometry::OdometryConfig& config, const transport::HostClock& clock, Rings& rings)
      : clock_(clock), rings_(rings), stage_(config) {}

  /// Sleeps until there is a scan, at most `longest`, and processes it.
  void run_once(Duration longest);

  OdometryCounts counts() const { return shown_.load().value_or(OdometryCounts{}); }
  threads::EventRing& events() { return events_; }
  const threads::StageMonitor& monitor() const { return monitor_; }

 private:
  void process(JobPool::Handle job);
  void hand_on(JobPool::Handle job);
  void copy_map();

  transport::HostClock clock_;
  Rings& rings_;
  stages::OdometryStage stage_;
  std::uint32_t next_place_ = 0;  // of the map that is being copied
  OdometryCounts counts_;
  // Written by the odometry thread, read by health.
  Latest<OdometryCounts> shown_;
  threads::EventRing events_;
  threads::StageMonitor monitor_;
};

}  // namespace slamd::pipeline
