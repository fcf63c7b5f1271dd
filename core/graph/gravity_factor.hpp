#pragma once

#include "core/geometry/se3.hpp"

namespace slamd::graph {

/// Where up is, as the filter saw it in base: levels the map, and leaves position and yaw alone.
struct GravityFactor {
  Eigen::Vector3d up_base = Eigen::Vector3d::UnitZ();  // a unit vector
  double std_rad = 0.01;                               // of each of its two angles
};

/// A residual with its derivative by δθ; the position has none.
struct GravityLinearised {
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 3> J_rotation;
};

/// Returns Bᵀ Rᵀ e_z, B the tangent plane at up_base: the sines of the two angles between up as measured and as the pose
/// has it. It is zero for an upside-down pose, too: tilts up to 90° are told apart, and no filter is off by more.
Eigen::Vector2d residual_of(const GravityFactor& factor, const geometry::Se3& T_map_base);

/// Returns the residual with its derivative Bᵀ [Rᵀ e_z]×.
GravityLinearised linearise(const GravityFactor& factor, const geometry::Se3& T_map_base);

}  // namespace slamd::graph
