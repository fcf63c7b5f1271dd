#pragma once

#include <span>

#include <Eigen/Core>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/map/voxel_map.hpp"

namespace slamd::psf {

/// How well a scan fits the map's surfaces at a pose: the particles' likelihood,
///   ℓ(ξ) = −(1/M) Σ min(r² / 2σ², 4.5),
/// with point-to-plane or point-to-line distances r; a point without a surface pays in full. ℓ lies in [−4.5, 0].
/// Source: design.md, "Likelihood"; likelihood field after Thrun et al., "Probabilistic Robotics", 6.4.
/// Real-time: allocates in the constructor only.
class ScanLikelihood {
 public:
  static constexpr float kFullCost = 4.5F;  // 3σ

  explicit ScanLikelihood(std::size_t max_points);

  /// Sets the points. Frames: imu.
  void set_points(std::span<const Eigen::Vector3f> points_imu);

  /// Evaluates ℓ with a look-up for each point, on one level of the map's coarse grid.
  float with_look_ups(const map::VoxelMap& map, std::size_t level, const geometry::Se3& T_odom_imu, float sigma_m) const;

  /// ℓ of two poses over the points that meet a surface at both, and how many of all points these are.
  struct Comparison {
    float a = -kFullCost;
    float b = -kFullCost;
    float share = 0.0F;
  };

  /// Compares two poses where both can be judged: what lies in unknown space at either says nothing for the other.
  Comparison compare(const map::VoxelMap& map, std::size_t level, const geometry::Se3& T_odom_imu_a,
                     const geometry::Se3& T_odom_imu_b, float sigma_m) const;

  /// Stores the surface that each point meets at a pose, for `with_cache`.
  void cache_surfaces(const map::VoxelMap& map, std::size_t level, const geometry::Se3& T_odom_imu);

  /// Evaluates ℓ against the stored surfaces.
  float with_cache(const geometry::Se3& T_odom_imu, float sigma_m) const;

  std::span<const Eigen::Vector3f> points_imu() const { return points_imu_.view(); }

 private:
  BoundedVector<Eigen::Vector3f> points_imu_;
  // The cache, one array a coordinate so that the compiler can use vector instructions. With e = q − mean and
  // a = axis · e: r² = along·a² + across·|e|², i.e. (1, 0) for a plane and (−1, 1) for a line.
  BoundedVector<float> x_, y_, z_;
  BoundedVector<float> mean_x_, mean_y_, mean_z_;
  BoundedVector<float> axis_x_, axis_y_, axis_z_;
  BoundedVector<float> along_, across_;
  BoundedVector<float> least_cost_;  // kFullCost for a point without a surface, else 0
};

}  // namespace slamd::psf
