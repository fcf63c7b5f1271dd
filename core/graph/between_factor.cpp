#include "core/graph/between_factor.hpp"

#include "core/geometry/so3.hpp"

namespace slamd::graph {

using geometry::Se3;
using geometry::Vector6d;

Vector6d residual_of(const BetweenFactor& factor, const Se3& T_map_a, const Se3& T_map_b) {
  return geometry::boxminus(T_map_a.inverse() * T_map_b, factor.T_a_b);
}

BetweenLinearised linearise(const BetweenFactor& factor, const Se3& T_map_a, const Se3& T_map_b) {
  const Se3 T_a_b = T_map_a.inverse() * T_map_b;
  BetweenLinearised out;
  out.residual = geometry::boxminus(T_a_b, factor.T_a_b);
  const Eigen::Matrix3d Jr_inverse = geometry::so3_right_jacobian_inverse(out.residual.tail<3>());
  out.J_a.setZero();
  out.J_a.topLeftCorner<3, 3>() = -T_map_a.rotation().transpose();
  out.J_a.topRightCorner<3, 3>() = geometry::skew(T_a_b.translation());
  out.J_a.bottomRightCorner<3, 3>() = -Jr_inverse * T_a_b.rotation().transpose();
  out.J_b.setZero();
  out.J_b.topLeftCorner<3, 3>() = T_map_a.rotation().transpose();
  out.J_b.bottomRightCorner<3, 3>() = Jr_inverse;
  return out;
}

}  // namespace slamd::graph
