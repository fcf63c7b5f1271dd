#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/cell_key.hpp"

namespace slamd::scan {

/// Lets one point per cube through: spreads a scan's points evenly over space, whatever their density.
/// Real-time: allocates in the constructor only; O(1) per point.
class VoxelSampler {
 public:
  explicit VoxelSampler(std::size_t max_points);

  /// Forgets all points, sets the cubes' side, and makes ready for `points` of them: the fewer, the less memory is
  /// touched. Units: m.
  void reset(float side_m, std::size_t points);

  /// Tells whether the point is the first in its cube since reset.
  bool admit(const Eigen::Vector3f& p);

 private:
  float inverse_side_ = 1.0F;
  std::uint64_t mask_ = 0;
  geometry::CellHash home_;
  BoundedVector<geometry::CellKey> slots_;
};

}  // namespace slamd::scan
