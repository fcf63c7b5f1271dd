#include "tools/loopnet/scan_context.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::loopnet {

namespace {

constexpr float kFarthest_m = 80.0F;
constexpr float kFloor_m = 2.0F;  // below

}  // namespace

ScanContext scan_context_of(const geometry::Se3& T_level_points, std::span<const Eigen::Vector3f> points) {
  ScanContext context;
  const Eigen::Matrix3f R = T_level_points.rotation().cast<float>();
  const Eigen::Vector3f t = T_level_points.translation().cast<float>();
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = R * point + t;
    const float range_m = p.head<2>().norm();
    if (!(range_m < kFarthest_m)) {
      continue;
    }
    const float turn = std::atan2(p.y(), p.x()) / (2.0F * static_cast<float>(M_PI));
    const auto sector = std::min(static_cast<std::size_t>((turn < 0.0F ? turn + 1.0F : turn) * ScanContext::kSectors),
                                 ScanContext::kSectors - 1);
    const auto ring = std::min(static_cast<std::size_t>(range_m / kFarthest_m * ScanContext::kRings), ScanContext::kRings - 1);
    float& height = context.heights_m[ring * ScanContext::kSectors + sector];
    height = std::max(height, p.z() + kFloor_m);
  }
  return context;
}

}  // namespace slamd::loopnet
