#include "daemon/pipeline/odometry_loop.hpp"

namespace slamd::pipeline {

using threads::Event;

void OdometryLoop::run_once(Duration longest) {
  rings_.wake_odometry.wait(longest);
  auto job = rings_.to_odometry.try_pop();
  while (job) {
    auto newer = rings_.to_odometry.try_pop();
    if (!newer) {
      process(std::move(*job));
      return;
    }
    stage_.skip((*job)->scan);
    ++counts_.skipped;
    events_.write(clock_.now(), Event::kScanSkipped, counts_.skipped);
    hand_on(std::move(*job));
    job = std::move(newer);
  }
}

void OdometryLoop::process(JobPool::Handle job) {
  const Stamp begin = clock_.now();
  job->result = stage_.process(job->scan);
  job->processed = true;
  const odometry::OdometryResult& result = job->result;
  const odometry::Odometry& odometry = stage_.odometry();
  job->anchor = {odometry.state(), odometry.covariance(), result.state, result.cause, result.weak_axes,
                 result.map_restarts};
  rings_.feedback.try_push(stage_.feedback());  // twice as long as the jobs that can be under way

  if (result.state != counts_.state || result.cause != counts_.cause) {
    events_.write(begin, Event::kStateChanged,
                  256 * static_cast<std::uint64_t>(result.state) + static_cast<std::uint64_t>(result.cause));
  }
  ++counts_.scans;
  counts_.recoveries += result.swarm.recovery ? 1 : 0;
  counts_.swarm_won += result.swarm.swarm_won ? 1 : 0;
  counts_.map_recycled = odometry.map().recycled();
  counts_.map_cells = static_cast<std::uint32_t>(odometry.map().cells());
  counts_.particles = result.swarm.particles;
  counts_.state = result.state;
  counts_.cause = result.cause;
  counts_.weak_axes = result.weak_axes;
  counts_.weak_axes_base = result.weak_axes_base;
  counts_.inlier_ratio = result.update.inlier_ratio;
  counts_.last = result.stamp;
  shown_.store(counts_);

  hand_on(std::move(job));
  const Stamp end = clock_.now();
  monitor_.add(end - begin, end);
}

void OdometryLoop::hand_on(JobPool::Handle job) {
  rings_.to_publish.try_push(std::move(job));  // as long as its pool: there is room
  rings_.wake_publish.notify();
  rings_.wake_preprocess.notify();
}

}  // namespace slamd::pipeline
