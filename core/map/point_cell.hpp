#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace slamd::map {

/// Eight points side by side, for vector instructions.
struct PointGroup {
  static constexpr std::uint32_t kSize = 8;
  /// Coordinate of a lane without a point: farther than any search reaches, and its square is finite. Units: m.
  static constexpr float kNowhere_m = 1e12F;

  float x_m[kSize]{};
  float y_m[kSize]{};
  float z_m[kSize]{};
};

/// A cube of the fine grid. It is divided into 4 × 4 × 4 sub-cubes, each of which holds at most one point, so that
/// the cube's memory is bounded and its points are spread evenly. Head and first group fill two cache lines.
/// Frames: coordinates in odom, relative to nothing.  Units: m.
struct alignas(64) PointCell {
  static constexpr std::uint32_t kDivisions = 4;
  static constexpr std::uint32_t kMaxPoints = kDivisions * kDivisions * kDivisions;

  void clear() {
    occupied = 0;
    count = 0;
  }

  std::uint32_t groups_in_use() const { return (count + PointGroup::kSize - 1) / PointGroup::kSize; }

  Eigen::Vector3f point(std::uint32_t i) const {
    const PointGroup& group = groups[i / PointGroup::kSize];
    const std::uint32_t lane = i % PointGroup::kSize;
    return {group.x_m[lane], group.y_m[lane], group.z_m[lane]};
  }

  /// Appends a point; there is room for one in each sub-cube.
  void add(const Eigen::Vector3f& p_odom) {
    PointGroup& group = groups[count / PointGroup::kSize];
    const std::uint32_t lane = count % PointGroup::kSize;
    if (lane == 0) {
      for (std::uint32_t i = 0; i < PointGroup::kSize; ++i) {
        group.x_m[i] = group.y_m[i] = group.z_m[i] = PointGroup::kNowhere_m;
      }
    }
    group.x_m[lane] = p_odom.x();
    group.y_m[lane] = p_odom.y();
    group.z_m[lane] = p_odom.z();
    ++count;
  }

  std::uint64_t occupied = 0;  // one bit a sub-cube
  std::uint32_t count = 0;
  alignas(32) PointGroup groups[kMaxPoints / PointGroup::kSize];
};

}  // namespace slamd::map
