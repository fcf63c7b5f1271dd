#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/geometry/se3.hpp"

namespace slamd::registration {

/// One scalar measurement: a point of the scan lies on a plane of the map. A point on a line is two of them, with
/// normals across the line.
/// Frames: point in imu, plane in odom: residual = n · (T_odom_imu p) + d.  Units: m.
struct Constraint {
  Eigen::Vector3f p_imu = Eigen::Vector3f::Zero();
  Eigen::Vector3f n_odom = Eigen::Vector3f::UnitZ();
  float d_m = 0.0F;
  float inverse_variance = 1.0F;  // 1/m², of the residual
  /// By how much the normal may be tilted: its most uncertain axis, times one standard deviation.  Units: rad.
  Eigen::Vector3f tilt_odom = Eigen::Vector3f::Zero();
};

/// Σ wJᵀJ and Σ wJᵀr over all constraints, in (δp, δθ) of T_odom_imu.
struct NormalEquations {
  geometry::Matrix6d H = geometry::Matrix6d::Zero();
  geometry::Vector6d g = geometry::Vector6d::Zero();
  double cost = 0.0;           // Σ of the robust kernel, dimensionless
  std::size_t count = 0;       // constraints
  std::size_t inliers = 0;     // within the kernel's scale
  double absolute_sum_m = 0.0;  // Σ|r|
};

/// Sums the constraints at a pose under a Cauchy kernel.
/// r(δ) ≈ r + nᵀδp + (p × Rᵀn)ᵀδθ.  Units: kernel_m in m; infinity for plain least squares.
/// Real-time: no allocation; O(constraints).
NormalEquations linearize(std::span<const Constraint> constraints,
                          const geometry::Se3& T_odom_imu,
                          double kernel_m);

/// Directions of odom along which surfaces are heard with caution.
struct WeakDirections {
  std::array<Eigen::Vector3d, 3> odom;
  std::size_t count = 0;
};

/// Returns what a normal has along a direction, less what its tilt may have made of it: all where it clearly faces the
/// direction, next to nothing where it could as well be square to it.
double trusted_along(const Constraint& constraint, const Eigen::Vector3d& direction_odom);

/// The same as linearize, but along weak directions each surface speaks by its trusted part only.
NormalEquations linearize_trusted(std::span<const Constraint> constraints,
                                  const geometry::Se3& T_odom_imu,
                                  double kernel_m,
                                  const WeakDirections& weak);

}  // namespace slamd::registration
