#include "core/mapping/cloud_builder.hpp"

#include <algorithm>

namespace slamd::mapping {

namespace {

/// Each time the cloud is too large, the cubes' volume doubles.
constexpr float kGrowth = 1.26F;

}  // namespace

CloudBuilder::CloudBuilder(std::size_t gathered)
    : gathering_(gathered), thinning_(gathered), points_(gathered), thinned_(gathered), ranges_m_(gathered) {}

void CloudBuilder::begin(float spacing_m) {
  spacing_m_ = spacing_m;
  gathering_.reset(spacing_m, points_.capacity());
  points_.clear();
}

void CloudBuilder::add(std::span<const Eigen::Vector3f> points_imu, const geometry::Se3& T_level_imu) {
  const Eigen::Matrix3f R = T_level_imu.rotation().cast<float>();
  const Eigen::Vector3f t = T_level_imu.translation().cast<float>();
  for (const Eigen::Vector3f& p_imu : points_imu) {
    const Eigen::Vector3f p = R * p_imu + t;
    if (points_.full()) {
      return;
    }
    if (p.allFinite() && gathering_.admit(p)) {
      points_.push_back(p);
    }
  }
}

std::span<const Eigen::Vector3f> CloudBuilder::thinned(std::size_t most) {
  if (points_.size() <= most) {
    return points_.view();
  }
  for (float side_m = kGrowth * spacing_m_;; side_m *= kGrowth) {
    thinning_.reset(side_m, points_.size());
    thinned_.clear();
    for (const Eigen::Vector3f& p : points_) {
      if (thinning_.admit(p)) {
        thinned_.push_back(p);
      }
    }
    if (thinned_.size() <= most) {
      return thinned_.view();
    }
  }
}

double CloudBuilder::median_range_m() {
  ranges_m_.clear();
  for (const Eigen::Vector3f& p : points_) {
    ranges_m_.push_back(p.norm());
  }
  if (ranges_m_.empty()) {
    return 0.0;
  }
  float* middle = ranges_m_.begin() + static_cast<std::ptrdiff_t>(ranges_m_.size() / 2);
  std::nth_element(ranges_m_.begin(), middle, ranges_m_.end());
  return static_cast<double>(*middle);
}

}  // namespace slamd::mapping
