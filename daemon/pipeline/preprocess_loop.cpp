#include "daemon/pipeline/preprocess_loop.hpp"

#include <algorithm>
#include <numeric>

#include "daemon/stages/packet_stage.hpp"

namespace slamd::pipeline {

using threads::Event;

namespace {

/// How often a scan that waits for its inertial samples is looked at.
constexpr Duration kWaitingStep = std::chrono::milliseconds(2);
/// What goes on happening is said so often.
constexpr Duration kSayAgain = std::chrono::seconds(5);

}  // namespace

PreprocessLoop::PreprocessLoop(const configuration::Configuration& configuration, const odometry::OdometryConfig& odometry,
                               const transport::HostClock& clock, Rings& rings)
    : config_(odometry),
      clock_(clock),
      rings_(rings),
      assembler_(stages::assembler_config(configuration)),
      stage_(odometry),
      waiting_(odometry.preprocess.max_points) {}

void PreprocessLoop::run_once(Duration longest) {
  rings_.wake_preprocess.wait(waiting_.is_waiting() ? std::min(longest, kWaitingStep) : longest);
  while (const auto feedback = rings_.feedback.try_pop()) {
    stage_.add_feedback(*feedback);
  }
  follow_epoch();
  take_wheels();
  take_imu();
  release(clock_.now());
  take_blocks();
  release(clock_.now());
  go_on_without_scan();
  show();
}

void PreprocessLoop::follow_epoch() {
  const std::uint32_t wanted = rings_.epoch_wanted.load(std::memory_order_relaxed);
  if (wanted != epoch_) {
    epoch_ = wanted;
    stage_.restart(wanted);
    events_.write(clock_.now(), Event::kNewMap);
  }
}

void PreprocessLoop::take_imu() {
  while (const auto arrival = rings_.imu_to_preprocess.try_pop()) {
    stage_.add_imu(arrival->sample);
  }
}

void PreprocessLoop::take_wheels() {
  while (const auto sample = rings_.wheels_to_preprocess.try_pop()) {
    stage_.add_wheel(*sample);
  }
}

void PreprocessLoop::take_blocks() {
  while (auto block = rings_.blocks.try_pop()) {
    const sensor::PointBlock& points = **block;
    if (const sensor::Scan* scan = assembler_.add(points)) {
      const Stamp now = clock_.now();
      waiting_.add(*scan, points.received, [&](const sensor::Scan& next) { return stage_.ready_for(next, now); },
                   [&](const sensor::Scan& next, Stamp received) { process(next, received, now); });
    }
    block->reset();
  }
}

void PreprocessLoop::release(Stamp now) {
  waiting_.release([&](const sensor::Scan& scan) { return stage_.ready_for(scan, now); },
                   [&](const sensor::Scan& scan, Stamp received) { process(scan, received, now); });
}

void PreprocessLoop::process(const sensor::Scan& scan, Stamp received, Stamp now) {
  if (!job_) {
    job_ = rings_.job_pool.acquire();
  }
  if (!job_) {
    ++counts_.scans_dropped;
    events_.write(now, Event::kScanDropped, counts_.scans_dropped);
    return;
  }
  if (config_.use_imu && (stage_.imu().empty() || stage_.imu().newest().stamp < scan.end)) {
    ++counts_.imu_late;
    if (now - imu_late_said_ >= kSayAgain) {
      imu_late_said_ = now;
      events_.write(now, Event::kImuLate, counts_.imu_late);
    }
  }
  if (!stage_.process(scan, job_->scan)) {
    counts_.scans_dropped += stage_.started() ? 1 : 0;  // it came too late
    return;                                             // or it is too early
  }
  job_->processed = false;
  job_->scan.received = received;
  if (job_->scan.start || job_->scan.start_without_imu) {
    events_.write(now, Event::kStarted, job_->scan.start ? (job_->scan.start->at_rest ? 1 : 0) : 2);
  }
  rings_.to_odometry.try_push(std::move(job_));  // as long as its pool: there is room
  rings_.wake_odometry.notify();
  const Stamp end = clock_.now();
  monitor_.add(end - now, end);
}

void PreprocessLoop::go_on_without_scan() {
  while (!waiting_.is_waiting()) {
    if (!job_) {
      job_ = rings_.job_pool.acquire();
    }
    if (!job_ || !stage_.go_on_without_scan(job_->scan)) {
      return;  // without a job the step waits: it needs no memory
    }
    job_->processed = false;
    rings_.to_odometry.try_push(std::move(job_));  // as long as its pool: there is room
    rings_.wake_odometry.notify();
  }
}

void PreprocessLoop::show() {
  const sensor::ScanAssemblerCounts& scans = assembler_.counts();
  counts_.scans = scans.scans;
  counts_.scans_incomplete = scans.scans_incomplete;
  counts_.blocks_missing = scans.blocks_missing;
  counts_.blocks_refused = std::accumulate(scans.blocks_refused.begin(), scans.blocks_refused.end(), std::uint64_t{0});
  counts_.late_feedback = stage_.late_feedback();
  const auto& refused = stage_.imu().counts().refused;
  counts_.imu_refused = std::accumulate(refused.begin(), refused.end(), std::uint64_t{0});
  counts_.aligned = stage_.alignment().has_value() || !config_.use_imu;
  shown_.store(counts_);
}

}  // namespace slamd::pipeline
