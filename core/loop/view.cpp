#include "core/loop/view.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::loop {

namespace {

constexpr float kBearing_rad = static_cast<float>(M_PI / 60.0);
constexpr float kNearest_m = 1.5F;  // nearer, a small error of the place is a large one of the direction
constexpr int kMostSeen = 5;        // of 9 directions

/// A surface at less of the range than that, and by so much, would have been seen.
constexpr float kClearlyBefore = 0.8F;
constexpr float kClearlyBefore_m = 0.3F;

}  // namespace

bool View::bin_of(const Eigen::Vector3f& p, int& azimuth, int& elevation) {
  azimuth = static_cast<int>((std::atan2(p.y(), p.x()) + static_cast<float>(M_PI)) / kBearing_rad) % kAzimuths;
  elevation = static_cast<int>(std::floor(std::atan2(p.z(), p.head<2>().norm()) / kBearing_rad)) + kElevations / 2;
  return elevation >= 0 && elevation < kElevations;
}

void View::add(std::span<const Eigen::Vector3f> points_view) {
  int azimuth = 0;
  int elevation = 0;
  for (const Eigen::Vector3f& p : points_view) {
    if (bin_of(p, azimuth, elevation)) {
      float& nearest_m = nearest_m_[static_cast<std::size_t>(elevation * kAzimuths + azimuth)];
      nearest_m = std::min(nearest_m, p.norm());
    }
  }
}

float View::nearest_around_m(int azimuth, int elevation) const {
  float nearest_m = std::numeric_limits<float>::infinity();
  int seen = 0;
  for (int e = std::max(0, elevation - 1); e <= std::min(kElevations - 1, elevation + 1); ++e) {
    for (int a = azimuth - 1; a <= azimuth + 1; ++a) {
      const float range_m = nearest_m_[static_cast<std::size_t>(e * kAzimuths + (a + kAzimuths) % kAzimuths)];
      seen += std::isfinite(range_m) ? 1 : 0;
      nearest_m = std::min(nearest_m, range_m);
    }
  }
  return seen >= kMostSeen ? nearest_m : std::numeric_limits<float>::infinity();
}

SeenThrough View::seen_through(std::span<const Eigen::Vector3f> points, const geometry::Se3& T_view_points) const {
  const Eigen::Matrix3f R = T_view_points.rotation().cast<float>();
  const Eigen::Vector3f t = T_view_points.translation().cast<float>();
  SeenThrough seen;
  int azimuth = 0;
  int elevation = 0;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = R * point + t;
    const float range_m = p.norm();
    if (!(range_m >= kNearest_m) || !bin_of(p, azimuth, elevation)) {
      continue;
    }
    const float nearest_m = nearest_around_m(azimuth, elevation);
    if (std::isfinite(nearest_m)) {
      ++seen.in_field;
      seen.through += range_m < kClearlyBefore * nearest_m - kClearlyBefore_m ? 1 : 0;
    }
  }
  return seen;
}

}  // namespace slamd::loop
