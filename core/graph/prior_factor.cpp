#include "core/graph/prior_factor.hpp"

#include "core/geometry/so3.hpp"

namespace slamd::graph {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

Vector6d residual_of(const PriorFactor& factor, const Se3& T_map_base) {
  return geometry::boxminus(T_map_base, factor.T_map_base);
}

PriorLinearised linearise(const PriorFactor& factor, const Se3& T_map_base) {
  PriorLinearised out;
  out.residual = residual_of(factor, T_map_base);
  out.J_pose.setIdentity();
  out.J_pose.bottomRightCorner<3, 3>() = geometry::so3_right_jacobian_inverse(out.residual.tail<3>());
  return out;
}

Matrix6d anchor_information() {
  constexpr double kPosition = 1e-3;
  constexpr double kYaw = 5e-5;
  Vector6d diagonal;
  diagonal << Eigen::Vector3d::Constant(1.0 / (kPosition * kPosition)), 0.0, 0.0, 1.0 / (kYaw * kYaw);
  return diagonal.asDiagonal();
}

}  // namespace slamd::graph
