#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/geometry/se3.hpp"

namespace slamd::loopnet {

/// The hand-made descriptor that Loop-Net is compared with: the greatest height above a floor 2 m below, by rings of 4 m to
/// 80 m and sectors of 6°; 0 where nothing is.
/// Source: Kim and Kim, "Scan Context", IROS 2018, with its published constants; own implementation.
struct ScanContext {
  static constexpr std::size_t kRings = 20;
  static constexpr std::size_t kSectors = 60;
  std::array<float, kRings * kSectors> heights_m{};
};

ScanContext scan_context_of(const geometry::Se3& T_level_points, std::span<const Eigen::Vector3f> points);

}  // namespace slamd::loopnet
