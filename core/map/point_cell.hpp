#pragma once

#include <cstddef>
#include <cstdint>

namespace slamd::map {

/// A cube of the fine grid. It is divided into 4 × 4 × 4 sub-cubes, each of which holds at most one point, so that
/// the cube's memory is bounded and its points are spread evenly.
/// Frames: coordinates in odom, relative to nothing.  Units: m.
struct PointCell {
  static constexpr std::uint32_t kDivisions = 4;
  static constexpr std::uint32_t kMaxPoints = kDivisions * kDivisions * kDivisions;

  std::uint64_t occupied = 0;  // one bit a sub-cube
  std::uint32_t count = 0;
  alignas(32) float x_m[kMaxPoints];
  alignas(32) float y_m[kMaxPoints];
  alignas(32) float z_m[kMaxPoints];
};

}  // namespace slamd::map
