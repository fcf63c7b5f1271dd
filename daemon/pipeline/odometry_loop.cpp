#include "daemon/pipeline/odometry_loop.hpp"

namespace slamd::pipeline {

using threads::Event;

namespace {

/// Of the map, copied between two scans: 0.8 MB.
constexpr std::size_t kCellsAtOnce = 1024;

constexpr std::uint64_t kScansAnAgreement = 10;

}  // namespace

void OdometryLoop::run_once(Duration longest) {
  rings_.wake_odometry.wait(longest);
  copy_map();
  auto job = rings_.to_odometry.try_pop();
  while (job) {
    auto newer = rings_.to_odometry.try_pop();
    if (!newer) {
      process(std::move(*job));
      return;
    }
    if ((*job)->scan.without_scan || (*newer)->scan.without_scan) {
      process(std::move(*job));  // it is cheap, or no newer scan
    } else {
      stage_.skip((*job)->scan);
      ++counts_.skipped;
      events_.write(clock_.now(), Event::kScanSkipped, counts_.skipped);
      hand_on(std::move(*job));
    }
    job = std::move(newer);
  }
}

void OdometryLoop::process(JobPool::Handle job) {
  const Stamp begin = clock_.now();
  const bool has_scan = !job->scan.without_scan;
  job->result = has_scan ? stage_.process(job->scan) : stage_.go_on_without_scan(job->scan);
  job->processed = true;
  const odometry::OdometryResult& result = job->result;
  const odometry::Odometry& odometry = stage_.odometry();
  job->motion = odometry.motion();
  job->anchor = {odometry.state(), odometry.covariance(), result.state, result.cause, result.weak_axes, job->scan.epoch,
                 result.map_restarts, odometry.shared_errors()};
  rings_.feedback.try_push(stage_.feedback());  // twice as long as the jobs that can be under way

  if (result.state != counts_.state || result.cause != counts_.cause) {
    events_.write(begin, Event::kStateChanged,
                  256 * static_cast<std::uint64_t>(result.state) + static_cast<std::uint64_t>(result.cause));
  }
  counts_.scans += has_scan ? 1 : 0;
  counts_.recoveries += result.swarm.recovery ? 1 : 0;
  counts_.swarm_won += result.swarm.swarm_won ? 1 : 0;
  counts_.map_recycled = odometry.map().recycled();
  counts_.wheels_used = odometry.wheels().counts().used;
  counts_.wheels_slipped = odometry.wheels().counts().slipped;
  counts_.map_cells = static_cast<std::uint32_t>(odometry.map().cells());
  if (has_scan) {
    counts_.particles = result.swarm.particles;
    counts_.inlier_ratio = result.update.inlier_ratio;
    counts_.last = result.stamp;
  }
  counts_.state = result.state;
  counts_.cause = result.cause;
  counts_.weak_axes = result.weak_axes;
  counts_.weak_axes_base = result.weak_axes_base;
  if (has_scan && counts_.scans % kScansAnAgreement == 0) {
    counts_.agreement = odometry.agreement();
  }
  counts_.epoch = job->scan.epoch;
  shown_.store(counts_);

  hand_on(std::move(job));
  const Stamp end = clock_.now();
  monitor_.add(end - begin, end);
}

// In parts, before a scan is looked for: a part takes a fraction of a millisecond. A cell that was made meanwhile at a
// place that was passed is not in the copy.
void OdometryLoop::copy_map() {
  const std::uint32_t wanted = rings_.map_wanted.load(std::memory_order_acquire);
  if (wanted == rings_.map_copied.load(std::memory_order_relaxed)) {
    return;
  }
  const auto& cells = stage_.odometry().map().fine_cells();
  std::size_t copied = 0;
  for (; next_place_ < cells.capacity() && copied < kCellsAtOnce; ++next_place_) {
    if (const map::PointCell* cell = cells.at(next_place_)) {
      if (!rings_.map_cells.try_push(*cell)) {
        return;  // housekeeping has to take some first
      }
      ++copied;
    }
  }
  if (next_place_ == cells.capacity()) {
    next_place_ = 0;
    rings_.map_copied.store(wanted, std::memory_order_release);
  }
}

void OdometryLoop::hand_on(JobPool::Handle job) {
  rings_.to_publish.try_push(std::move(job));  // as long as its pool: there is room
  rings_.wake_publish.notify();
  rings_.wake_preprocess.notify();
}

}  // namespace slamd::pipeline
