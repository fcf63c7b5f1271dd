#pragma once

#include <atomic>

#include "core/sensor/scan_assembler.hpp"
#include "daemon/configuration/configuration.hpp"
#include "daemon/pipeline/rings.hpp"
#include "daemon/stages/waiting_scan.hpp"
#include "daemon/threads/event_ring.hpp"
#include "daemon/threads/stage_monitor.hpp"
#include "drivers/transport/host_clock.hpp"

namespace slamd::pipeline {

/// What the preprocess thread shows.
struct PreprocessCounts {
  std::uint64_t scans = 0;             // assembled
  std::uint64_t scans_incomplete = 0;  // of these: packets were missing
  std::uint64_t blocks_missing = 0;    // by the gaps between stamps
  std::uint64_t blocks_refused = 0;
  std::uint64_t scans_dropped = 0;     // no free job: publish or odometry is stuck; or the scan came too late
  std::uint64_t imu_late = 0;          // scans that went on without the samples up to their end
  std::uint64_t late_feedback = 0;     // scans deskewed with an older state than k−2
  std::uint64_t imu_refused = 0;
  bool aligned = false;
};

/// The preprocess thread: blocks to scans to features.
/// Threads: run_once() by one; counts() by any.  Real-time: allocates in the constructor only; sleeps in one WakeUp.
class PreprocessLoop {
 public:
  PreprocessLoop(const configuration::Configuration& configuration, const odometry::OdometryConfig& odometry,
                 const transport::HostClock& clock, Rings& rings);

  /// Sleeps until there is something to do, at most `longest`, and does it.
  void run_once(Duration longest);

  PreprocessCounts counts() const { return shown_.load().value_or(PreprocessCounts{}); }
  threads::EventRing& events() { return events_; }
  const threads::StageMonitor& monitor() const { return monitor_; }

  /// For after the thread has ended.
  const sensor::ScanAssemblerCounts& assembler_counts() const { return assembler_.counts(); }

 private:
  void follow_epoch();
  void take_imu();
  void take_wheels();
  void take_blocks();
  void release(Stamp now);
  void process(const sensor::Scan& scan, Stamp received, Stamp now);
  void go_on_without_scan();
  void show();

  const odometry::OdometryConfig config_;
  transport::HostClock clock_;
  Rings& rings_;
  sensor::ScanAssembler assembler_;
  stages::PreprocessStage stage_;
  JobPool::Handle job_;      // the next scan's, kept when starting does not need it
  stages::WaitingScan waiting_;
  std::uint32_t epoch_ = 1;
  Stamp imu_late_said_{};
  PreprocessCounts counts_;
  // Written by the preprocess thread, read by health.
  Latest<PreprocessCounts> shown_;
  threads::EventRing events_;
  threads::StageMonitor monitor_;
};

}  // namespace slamd::pipeline
