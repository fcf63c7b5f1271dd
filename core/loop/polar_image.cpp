#include "core/loop/polar_image.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::loop {

namespace {

constexpr float kTurn_rad = 6.28318530718F;

/// Cells of n points.
std::array<std::uint8_t, 256> make_levels() {
  std::array<std::uint8_t, 256> levels{};
  for (std::size_t n = 0; n < levels.size(); ++n) {
    levels[n] = static_cast<std::uint8_t>(std::min(255.0, std::round(32.0 * std::log2(1.0 + static_cast<double>(n)))));
  }
  return levels;
}

std::size_t slice_of(float height_m) {
  std::size_t slice = 0;
  for (const float top_m : PolarImage::kSliceTops_m) {
    slice += height_m >= top_m ? 1 : 0;
  }
  return slice;
}

}  // namespace

geometry::Se3 level_of(const geometry::Se3& T_odom_base) {
  const double yaw_rad = std::atan2(T_odom_base.rotation()(1, 0), T_odom_base.rotation()(0, 0));
  return {Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix(), T_odom_base.translation()};
}

PolarImager::PolarImager() : counts_(PolarImage::kCells) {}

void PolarImager::clear() {
  std::fill(counts_.begin(), counts_.end(), std::uint8_t{0});
}

void PolarImager::add(const geometry::Se3& T_level_points, std::span<const Eigen::Vector3f> points) {
  const Eigen::Matrix3f R = T_level_points.rotation().cast<float>();
  const Eigen::Vector3f t = T_level_points.translation().cast<float>();
  static const float rings_per_log = static_cast<float>(PolarImage::kRings) /
                                     std::log(PolarImage::kFarthest_m / PolarImage::kNearest_m);
  constexpr float kAzimuthsPerRadian = static_cast<float>(PolarImage::kAzimuths) / kTurn_rad;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = R * point + t;
    const float range_m = std::sqrt(p.x() * p.x() + p.y() * p.y());
    if (!(range_m >= PolarImage::kNearest_m && range_m < PolarImage::kFarthest_m) || !std::isfinite(p.z())) {
      continue;
    }
    const auto ring = static_cast<std::size_t>(std::log(range_m / PolarImage::kNearest_m) * rings_per_log);
    const float azimuth_rad = std::atan2(p.y(), p.x());
    const float column = (azimuth_rad < 0.0F ? azimuth_rad + kTurn_rad : azimuth_rad) * kAzimuthsPerRadian;
    const std::size_t azimuth = std::min(static_cast<std::size_t>(column), PolarImage::kAzimuths - 1);
    std::uint8_t& count =
        counts_[PolarImage::index(slice_of(p.z()), std::min(ring, PolarImage::kRings - 1), azimuth)];
    count = static_cast<std::uint8_t>(count + (count < 255 ? 1 : 0));
  }
}

void PolarImager::finish(PolarImage& image) const {
  static const std::array<std::uint8_t, 256> levels = make_levels();
  std::transform(counts_.begin(), counts_.end(), image.cells.begin(),
                 [](std::uint8_t count) { return levels[count]; });
}

}  // namespace slamd::loop
