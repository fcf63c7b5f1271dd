#include "core/graph/gnss_factor.hpp"

#include "core/geometry/so3.hpp"

namespace slamd::graph {

using geometry::Se3;

Eigen::Vector3d residual_of(const GnssFactor& factor, const Se3& T_map_base, const GnssAlignment& alignment) {
  return T_map_base * factor.p_base_antenna - alignment * factor.p_enu;
}

GnssLinearised linearise(const GnssFactor& factor, const Se3& T_map_base, const GnssAlignment& alignment) {
  GnssLinearised out;
  out.residual = residual_of(factor, T_map_base, alignment);
  out.J_pose.leftCols<3>().setIdentity();
  out.J_pose.rightCols<3>() = -T_map_base.rotation() * geometry::skew(factor.p_base_antenna);
  out.J_alignment.leftCols<3>() = -Eigen::Matrix3d::Identity();
  out.J_alignment.col(3) = -alignment.R_map_enu() * Eigen::Vector3d(-factor.p_enu.y(), factor.p_enu.x(), 0.0);
  return out;
}

}  // namespace slamd::graph
