#pragma once

#include <optional>
#include <vector>

#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"

namespace slamd::evaluation {

/// A pose at a time: T_world_body.
struct TimedPose {
  Stamp stamp{};
  geometry::Se3 T;
};

/// Poses in the order of their stamps.
using Trajectory = std::vector<TimedPose>;

/// A reference pose and an estimated one, at the estimate's stamp.
struct PosePair {
  Stamp stamp{};
  geometry::Se3 reference;
  geometry::Se3 estimate;
};

/// Returns the pose at a time, interpolated between its neighbours; nothing outside the trajectory, or in a gap of it longer
/// than `max_gap`.
std::optional<geometry::Se3> interpolated_at(const Trajectory& trajectory, Stamp stamp, Duration max_gap = Duration::max());

/// Pairs each estimate with the reference interpolated at its stamp; estimates outside the reference, or in a gap of it
/// longer than `max_gap`, are left out.
std::vector<PosePair> associate_interpolated(const Trajectory& reference, const Trajectory& estimate, Duration max_gap);

/// Pairs as evo does: each stamp of the shorter trajectory with the nearest of the longer one, accepted up to
/// `max_difference` inclusive, not one to one; at equal lengths the reference counts as the longer one.
/// Source: evo core/sync.py, re-implemented from its description.
std::vector<PosePair> associate_nearest(const Trajectory& reference, const Trajectory& estimate, Duration max_difference);

/// Sum of the distances between neighbours. Units: m.
double path_length_m(const Trajectory& trajectory);

}  // namespace slamd::evaluation
