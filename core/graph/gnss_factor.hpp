#pragma once

#include "core/geometry/se3.hpp"
#include "core/graph/gnss_alignment.hpp"

namespace slamd::graph {

/// A satellite receiver's position of the antenna. Its horizontal error is the same in all directions, so that the yaw of
/// the alignment does not turn it.
/// Frames: p_enu in east, north, up from an origin near by; p_base_antenna in base of the keyframe (the lever arm).
struct GnssFactor {
  Eigen::Vector3d p_enu = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_base_antenna = Eigen::Vector3d::Zero();
  double horizontal_std_m = 1.0;
  double vertical_std_m = 1.0;  // infinite where the receiver gives no height

  Eigen::Vector3d information_diagonal() const {
    const double h = 1.0 / (horizontal_std_m * horizontal_std_m);
    return {h, h, 1.0 / (vertical_std_m * vertical_std_m)};
  }
};

/// A residual with its derivatives by (δp, δθ) of the pose and (δp, δyaw) of the alignment.
struct GnssLinearised {
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 6> J_pose;
  Eigen::Matrix<double, 3, 4> J_alignment;
};

/// Returns p + R p_base_antenna − T_map_enu p_enu.  Units: m, in map.
Eigen::Vector3d residual_of(const GnssFactor& factor, const geometry::Se3& T_map_base, const GnssAlignment& alignment);

/// Returns the residual with its derivatives.
GnssLinearised linearise(const GnssFactor& factor, const geometry::Se3& T_map_base, const GnssAlignment& alignment);

}  // namespace slamd::graph
