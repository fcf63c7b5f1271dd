#include "core/evaluation/trajectory.hpp"

#include <algorithm>

namespace slamd::evaluation {

namespace {

bool earlier(const TimedPose& pose, Stamp stamp) { return pose.stamp < stamp; }

/// Returns the pose whose stamp is nearest; the earlier one of two equally near.
const TimedPose& nearest(const Trajectory& trajectory, Stamp stamp) {
  auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp, earlier);
  if (after == trajectory.end() ||
      (after != trajectory.begin() && stamp - std::prev(after)->stamp <= after->stamp - stamp)) {
    --after;
  }
  return *after;
}

}  // namespace

std::optional<geometry::Se3> interpolated_at(const Trajectory& trajectory, Stamp stamp, Duration max_gap) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp, earlier);
  if (after == trajectory.end()) {
    return std::nullopt;
  }
  if (after->stamp == stamp) {
    return after->T;
  }
  if (after == trajectory.begin()) {
    return std::nullopt;
  }
  const TimedPose& before = *std::prev(after);
  const Duration gap = after->stamp - before.stamp;
  if (gap > max_gap) {
    return std::nullopt;
  }
  return geometry::interpolate(before.T, after->T, to_seconds(stamp - before.stamp) / to_seconds(gap));
}

std::vector<PosePair> associate_interpolated(const Trajectory& reference, const Trajectory& estimate, Duration max_gap) {
  std::vector<PosePair> pairs;
  for (const TimedPose& pose : estimate) {
    if (const auto T = interpolated_at(reference, pose.stamp, max_gap)) {
      pairs.push_back({pose.stamp, *T, pose.T});
    }
  }
  return pairs;
}

std::vector<PosePair> associate_nearest(const Trajectory& reference, const Trajectory& estimate, Duration max_difference) {
  std::vector<PosePair> pairs;
  if (reference.empty() || estimate.empty()) {
    return pairs;
  }
  const bool estimate_is_longer = estimate.size() > reference.size();
  const Trajectory& shorter = estimate_is_longer ? reference : estimate;
  const Trajectory& longer = estimate_is_longer ? estimate : reference;
  for (const TimedPose& pose : shorter) {
    const TimedPose& other = nearest(longer, pose.stamp);
    const Duration difference = other.stamp > pose.stamp ? other.stamp - pose.stamp : pose.stamp - other.stamp;
    if (difference <= max_difference) {
      pairs.push_back(estimate_is_longer ? PosePair{other.stamp, pose.T, other.T}
                                         : PosePair{pose.stamp, other.T, pose.T});
    }
  }
  return pairs;
}

double path_length_m(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].T.translation() - trajectory[i - 1].T.translation()).norm();
  }
  return length;
}

}  // namespace slamd::evaluation
