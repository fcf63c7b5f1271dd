#include "core/inertial/nav_state.hpp"

#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::inertial {

Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& g) {
  const Eigen::Vector3d direction = g.normalized();
  const Eigen::Vector3d helper =
      std::abs(direction.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.cross(helper).normalized();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

NavState boxplus(const NavState& state, const ErrorState& delta) {
  NavState result = state;
  result.T_odom_imu = geometry::boxplus(state.T_odom_imu, delta.segment<6>(kPosition));
  result.v_odom_imu += delta.segment<3>(kVelocity);
  result.gyro_bias += delta.segment<3>(kGyroBias);
  result.accel_bias += delta.segment<3>(kAccelBias);
  result.g_odom = geometry::so3_exp(tangent_basis(state.g_odom) * delta.segment<2>(kGravity)) * state.g_odom;
  return result;
}

ErrorState boxminus(const NavState& a, const NavState& b) {
  ErrorState delta;
  delta.segment<6>(kPosition) = geometry::boxminus(a.T_odom_imu, b.T_odom_imu);
  delta.segment<3>(kVelocity) = a.v_odom_imu - b.v_odom_imu;
  delta.segment<3>(kGyroBias) = a.gyro_bias - b.gyro_bias;
  delta.segment<3>(kAccelBias) = a.accel_bias - b.accel_bias;
  const Eigen::Vector3d rotation = b.g_odom.cross(a.g_odom) / b.g_odom.squaredNorm();
  delta.segment<2>(kGravity) = tangent_basis(b.g_odom).transpose() * rotation;
  return delta;
}

}  // namespace slamd::inertial
