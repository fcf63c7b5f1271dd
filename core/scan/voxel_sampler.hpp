#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "core/base/bounded_vector.hpp"

namespace slamd::scan {

/// Lets one point per cube through: spreads a scan's points evenly over space, whatever their density.
/// Real-time: allocates in the constructor only; O(1) per point.
class VoxelSampler {
 public:
  explicit VoxelSampler(std::size_t max_points);

  /// Forgets all points and sets the cubes' side. Units: m.
  void reset(float side_m);

  /// Tells whether the point is the first in its cube since reset.
  bool admit(const Eigen::Vector3f& p);

 private:
  float inverse_side_ = 1.0F;
  std::uint32_t generation_ = 0;  // a slot counts only when it carries the current generation
  std::uint64_t mask_ = 0;
  struct Slot {
    std::uint64_t key;
    std::uint32_t generation;
  };
  BoundedVector<Slot> slots_;
};

}  // namespace slamd::scan
