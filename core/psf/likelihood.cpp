#include "core/psf/likelihood.hpp"

#include <algorithm>

namespace slamd::psf {

using geometry::Se3;
using map::Surface;
using map::SurfaceCell;

ScanLikelihood::ScanLikelihood(std::size_t max_points)
    : points_imu_(max_points),
      x_(max_points),
      y_(max_points),
      z_(max_points),
      mean_x_(max_points),
      mean_y_(max_points),
      mean_z_(max_points),
      axis_x_(max_points),
      axis_y_(max_points),
      axis_z_(max_points),
      along_(max_points),
      across_(max_points),
      least_cost_(max_points) {}

void ScanLikelihood::set_points(std::span<const Eigen::Vector3f> points_imu) {
  points_imu_.assign(points_imu.first(std::min(points_imu.size(), points_imu_.capacity())));
  const std::size_t count = points_imu_.size();
  for (auto* array : {&x_, &y_, &z_, &mean_x_, &mean_y_, &mean_z_, &axis_x_, &axis_y_, &axis_z_, &along_, &across_,
                      &least_cost_}) {
    array->resize(count);
  }
  for (std::size_t i = 0; i < count; ++i) {
    x_[i] = points_imu_[i].x();
    y_[i] = points_imu_[i].y();
    z_[i] = points_imu_[i].z();
  }
}

float ScanLikelihood::with_look_ups(const map::VoxelMap& map,
                                    std::size_t level,
                                    const Se3& T_odom_imu,
                                    float sigma_m) const {
  if (points_imu_.empty()) {
    return -kFullCost;
  }
  const Eigen::Matrix3f R = T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = T_odom_imu.translation().cast<float>();
  const float scale = 0.5F / (sigma_m * sigma_m);
  float cost = 0.0F;
  for (const Eigen::Vector3f& p_imu : points_imu_) {
    const Eigen::Vector3f p_odom = R * p_imu + t;
    const SurfaceCell* cell = map.surface(p_odom, level);
    if (cell == nullptr || cell->surface == Surface::kUnknown) {
      cost += kFullCost;
      continue;
    }
    const float r = cell->distance_m(p_odom);
    cost += std::min(scale * r * r, kFullCost);
  }
  return -cost / static_cast<float>(points_imu_.size());
}

ScanLikelihood::Comparison ScanLikelihood::compare(const map::VoxelMap& map,
                                                   std::size_t level,
                                                   const Se3& T_odom_imu_a,
                                                   const Se3& T_odom_imu_b,
                                                   float sigma_m) const {
  const Eigen::Matrix3f R_a = T_odom_imu_a.rotation().cast<float>();
  const Eigen::Vector3f t_a = T_odom_imu_a.translation().cast<float>();
  const Eigen::Matrix3f R_b = T_odom_imu_b.rotation().cast<float>();
  const Eigen::Vector3f t_b = T_odom_imu_b.translation().cast<float>();
  const float scale = 0.5F / (sigma_m * sigma_m);
  const auto cost = [scale](float r) { return std::min(scale * r * r, kFullCost); };
  Comparison result;
  float cost_a = 0.0F;
  float cost_b = 0.0F;
  std::size_t shared = 0;
  for (const Eigen::Vector3f& p_imu : points_imu_) {
    const Eigen::Vector3f p_a = R_a * p_imu + t_a;
    const Eigen::Vector3f p_b = R_b * p_imu + t_b;
    const SurfaceCell* cell_a = map.surface(p_a, level);
    const SurfaceCell* cell_b = map.surface(p_b, level);
    if (cell_a == nullptr || cell_b == nullptr || cell_a->surface == Surface::kUnknown || cell_b->surface == Surface::kUnknown) {
      continue;
    }
    cost_a += cost(cell_a->distance_m(p_a));
    cost_b += cost(cell_b->distance_m(p_b));
    ++shared;
  }
  if (shared > 0) {
    result.a = -cost_a / static_cast<float>(shared);
    result.b = -cost_b / static_cast<float>(shared);
    result.share = static_cast<float>(shared) / static_cast<float>(points_imu_.size());
  }
  return result;
}

void ScanLikelihood::cache_surfaces(const map::VoxelMap& map, std::size_t level, const Se3& T_odom_imu) {
  const Eigen::Matrix3f R = T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = T_odom_imu.translation().cast<float>();
  for (std::size_t i = 0; i < points_imu_.size(); ++i) {
    const Eigen::Vector3f p_odom = R * points_imu_[i] + t;
    const SurfaceCell* cell = map.surface(p_odom, level);
    const bool known = cell != nullptr && cell->surface != Surface::kUnknown;
    const bool line = known && cell->surface == Surface::kLine;
    least_cost_[i] = known ? 0.0F : kFullCost;
    along_[i] = line ? -1.0F : 1.0F;
    across_[i] = line ? 1.0F : 0.0F;
    const Eigen::Vector3f mean = known ? cell->mean_odom : Eigen::Vector3f::Zero();
    const Eigen::Vector3f axis = line ? cell->axis_odom : known ? cell->normal_near(p_odom) : Eigen::Vector3f::Zero();
    mean_x_[i] = mean.x();
    mean_y_[i] = mean.y();
    mean_z_[i] = mean.z();
    axis_x_[i] = axis.x();
    axis_y_[i] = axis.y();
    axis_z_[i] = axis.z();
  }
}

float ScanLikelihood::with_cache(const Se3& T_odom_imu, float sigma_m) const {
  const std::size_t count = points_imu_.size();
  if (count == 0) {
    return -kFullCost;
  }
  const Eigen::Matrix3f R = T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = T_odom_imu.translation().cast<float>();
  const float scale = 0.5F / (sigma_m * sigma_m);
  const float* const x = x_.data();
  const float* const y = y_.data();
  const float* const z = z_.data();
  const float* const mean_x = mean_x_.data();
  const float* const mean_y = mean_y_.data();
  const float* const mean_z = mean_z_.data();
  const float* const axis_x = axis_x_.data();
  const float* const axis_y = axis_y_.data();
  const float* const axis_z = axis_z_.data();
  const float* const along = along_.data();
  const float* const across = across_.data();
  const float* const least_cost = least_cost_.data();
  const auto cost_of = [&](std::size_t i) {
    const float ex = R(0, 0) * x[i] + R(0, 1) * y[i] + R(0, 2) * z[i] + t.x() - mean_x[i];
    const float ey = R(1, 0) * x[i] + R(1, 1) * y[i] + R(1, 2) * z[i] + t.y() - mean_y[i];
    const float ez = R(2, 0) * x[i] + R(2, 1) * y[i] + R(2, 2) * z[i] + t.z() - mean_z[i];
    const float a = axis_x[i] * ex + axis_y[i] * ey + axis_z[i] * ez;
    const float r_sq = along[i] * a * a + across[i] * (ex * ex + ey * ey + ez * ez);
    const float cost = std::min(scale * r_sq, kFullCost);
    return std::max(cost, least_cost[i]);
  };
  // Four running sums side by side: vector instructions, and the same order of the additions everywhere.
  constexpr std::size_t kLanes = 4;
  float cost[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      cost[lane] += cost_of(i + lane);
    }
  }
  for (std::size_t lane = 0; i < count; ++i, ++lane) {
    cost[lane] += cost_of(i);
  }
  return -((cost[0] + cost[1]) + (cost[2] + cost[3])) / static_cast<float>(count);
}

}  // namespace slamd::psf
