#include "core/odometry/motion_covariance.hpp"

#include "core/geometry/so3.hpp"
#include "core/odometry/map_drift.hpp"

namespace slamd::odometry {

using geometry::Matrix6d;
using geometry::Se3;

Matrix6d composed_drift(const Matrix6d& drift, const Se3& T_a_b, const Se3& T_b_c, const Matrix6d& drift_c) {
  Matrix6d on = Matrix6d::Identity();
  on.topRightCorner<3, 3>() = -T_a_b.rotation() * geometry::skew(T_b_c.translation());
  on.bottomRightCorner<3, 3>() = T_b_c.rotation().transpose();
  Matrix6d turned = Matrix6d::Identity();
  turned.topLeftCorner<3, 3>() = T_a_b.rotation() * T_b_c.rotation();
  return on * drift * on.transpose() + turned * drift_c * turned.transpose();
}

MotionCovariance::MotionCovariance(const MotionStep& first)
    : T_odom_first_(first.T_odom_base),
      P_first_(first.J_base_imu * first.P_filter_base.topRows<6>()),
      T_odom_last_(T_odom_first_),
      P_last_(P_first_),
      C_last_first_(first.P_filter_base),
      J_base_imu_(first.J_base_imu) {}

void MotionCovariance::add(const MotionStep& next) {
  C_last_first_ = (next.transition * C_last_first_).eval();
  J_base_imu_ = next.J_base_imu;
  P_last_ = next.J_base_imu * next.P_filter_base.topRows<6>();
  drift_ = composed_drift(drift_, T_odom_first_.inverse() * T_odom_last_, T_odom_last_.inverse() * next.T_odom_base,
                          next.drift_base);
  blind_odom_ += next.blind_odom;
  T_odom_last_ = next.T_odom_base;
}

Matrix6d MotionCovariance::covariance() const {
  const Se3 T_first_last = T_odom_first_.inverse() * T_odom_last_;
  const Eigen::Matrix3d R_first_odom = T_odom_first_.rotation().transpose();
  // δp = R_firstᵀ(δp_last − δp_first) + [p]× δθ_first and δθ = δθ_last − R_first_lastᵀ δθ_first.
  Matrix6d J_first = Matrix6d::Zero();
  J_first.topLeftCorner<3, 3>() = -R_first_odom;
  J_first.topRightCorner<3, 3>() = geometry::skew(T_first_last.translation());
  J_first.bottomRightCorner<3, 3>() = -T_first_last.rotation().transpose();
  Matrix6d J_last = Matrix6d::Identity();
  J_last.topLeftCorner<3, 3>() = R_first_odom;
  const Matrix6d common = J_last * (J_base_imu_ * C_last_first_.topRows<6>()) * J_first.transpose();
  const Matrix6d shared = errors_of_all_points();
  Matrix6d P = J_first * (P_first_ + shared) * J_first.transpose() + J_last * (P_last_ + shared) * J_last.transpose() + common +
               common.transpose() + drift_;
  const Eigen::Vector3d blind_first = R_first_odom * blind_odom_;
  P.topLeftCorner<3, 3>() += blind_first * blind_first.transpose();
  return 0.5 * (P + P.transpose());
}

}  // namespace slamd::odometry
