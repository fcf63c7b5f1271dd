#include "core/graph/gravity_factor.hpp"

#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::graph {

using geometry::Se3;

namespace {

/// Two unit vectors that span the plane across v.
Eigen::Matrix<double, 3, 2> tangent_of(const Eigen::Vector3d& v) {
  const Eigen::Vector3d other = std::abs(v.x()) < 0.7 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix<double, 3, 2> B;
  B.col(0) = v.cross(other).normalized();
  B.col(1) = v.cross(B.col(0));
  return B;
}

}  // namespace

Eigen::Vector2d residual_of(const GravityFactor& factor, const Se3& T_map_base) {
  return tangent_of(factor.up_base).transpose() * T_map_base.rotation().row(2).transpose();
}

GravityLinearised linearise(const GravityFactor& factor, const Se3& T_map_base) {
  const Eigen::Vector3d up = T_map_base.rotation().row(2).transpose();
  const Eigen::Matrix<double, 3, 2> B = tangent_of(factor.up_base);
  return {B.transpose() * up, B.transpose() * geometry::skew(up)};
}

}  // namespace slamd::graph
