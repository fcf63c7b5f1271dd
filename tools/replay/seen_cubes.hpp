#pragma once

#include <bitset>
#include <unordered_map>

#include <Eigen/Core>

#include "core/geometry/cell_key.hpp"

namespace slamd::replay {

/// The cubes of space that have been seen: a whole drive's, in memory that grows with them. Eight by eight by eight cubes
/// lie side by side, for what is near in space is asked for together.
/// Units: m.
class SeenCubes {
 public:
  explicit SeenCubes(float side_m) : inverse_side_(1.0F / side_m) {}

  /// Tells whether the point is the first in its cube.
  bool admit(const Eigen::Vector3f& p) {
    const std::int32_t x = geometry::cell_index(p.x(), inverse_side_);
    const std::int32_t y = geometry::cell_index(p.y(), inverse_side_);
    const std::int32_t z = geometry::cell_index(p.z(), inverse_side_);
    auto cube = blocks_[geometry::pack(x >> kShift, y >> kShift, z >> kShift)][place_in_block(x, y, z)];
    const bool first = !cube;
    cube = true;
    return first;
  }

 private:
  static constexpr int kShift = 3;
  static constexpr std::int32_t kInBlock = (1 << kShift) - 1;

  static std::size_t place_in_block(std::int32_t x, std::int32_t y, std::int32_t z) {
    return static_cast<std::size_t>((((x & kInBlock) << kShift | (y & kInBlock)) << kShift) | (z & kInBlock));
  }

  float inverse_side_;
  std::unordered_map<geometry::CellKey, std::bitset<1U << (3 * kShift)>> blocks_;
};

}  // namespace slamd::replay
