#pragma once

#include <Eigen/Core>

#include "core/base/fixed_vector.hpp"

namespace slamd::scan {

/// An axis-aligned box in base.  Units: m.
struct Box {
  float min_m[3];
  float max_m[3];
};

/// Tells which points are the robot's own body, or outside the range that is trusted.
struct SelfFilter {
  static constexpr std::size_t kMaxBoxes = 8;

  FixedVector<Box, kMaxBoxes> boxes_base;
  float min_range_m = 0.5F;
  float max_range_m = 120.0F;

  /// Tells whether a point is to be used. Frames: p_base in base; range from the sensor's origin.
  bool keeps(const Eigen::Vector3f& p_base, float range_m) const {
    if (!(range_m >= min_range_m && range_m <= max_range_m)) {
      return false;
    }
    for (const Box& box : boxes_base) {
      bool inside = true;
      for (int axis = 0; axis < 3; ++axis) {
        inside = inside && p_base[axis] >= box.min_m[axis] && p_base[axis] <= box.max_m[axis];
      }
      if (inside) {
        return false;
      }
    }
    return true;
  }
};

}  // namespace slamd::scan
