#include "daemon/pipeline/occupancy_loop.hpp"

namespace slamd::pipeline {

namespace {

/// Without scans the map is told so often, so that clients hear that nothing has changed, and get what they ask for.
constexpr Duration kTellPeriod = std::chrono::milliseconds(200);

}  // namespace

OccupancyLoop::OccupancyLoop(const occupancy::GridConfig& config, const transport::HostClock& clock, Rings& rings, bus::Publisher& publisher)
    : clock_(clock), rings_(rings), publisher_(publisher), stage_(config, {}, clock.now()) {}

void OccupancyLoop::run_once(Duration longest) {
  rings_.wake_occupancy.wait(longest);
  while (const auto request = rings_.map_requests.try_pop()) {
    stage_.request(*request);
  }
  if (auto scan = rings_.to_occupancy.try_pop()) {  // one a round: each is a sign of life
    const Stamp begin = clock_.now();
    stage_.process(scan->scan, scan->points->view(), rings_.newest_submap.load().value_or(stages::NewestSubmap{}), begin);
    scan->points.reset();
    const Stamp end = clock_.now();
    monitor_.add(end - begin, end);
    ++counts_.scans;
    tell(end);
    if (!rings_.to_occupancy.empty()) {
      rings_.wake_occupancy.notify();
    }
  } else if (const Stamp now = clock_.now(); counts_.scans > 0 && now - told_ >= kTellPeriod) {
    tell(now);
  }
  shown_.store(counts_);
}

void OccupancyLoop::tell(Stamp now) {
  told_ = now;
  stage_.tell([this](const occupancy::MapDelta& message, occupancy::DeltaKind kind) {
    publisher_.publish(message, kind == occupancy::DeltaKind::kRepair);
    ++(kind == occupancy::DeltaKind::kChange ? counts_.changes : kind == occupancy::DeltaKind::kKey ? counts_.keys : counts_.repairs);
  });
}

}  // namespace slamd::pipeline
