#include "core/odometry/map_drift.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace slamd::odometry {

using geometry::Matrix6d;
using geometry::Se3;

namespace {

/// A scan that says little of a direction lays surfaces no worse than this: from one scan to the next the inertial sensor
/// or the wheels hold it so well.  Units: m, rad.
constexpr double kMostLaid_m = 0.01;
constexpr double kMostLaid_rad = 0.002;

constexpr double kLeastRange_m = 1.0;

}  // namespace

Eigen::Matrix<double, inertial::kFilterStates, 6> with_true_noise(
    const Eigen::Matrix<double, inertial::kFilterStates, 6>& P_pose, const Matrix6d& H) {
  return P_pose - (1.0 - kTrueNoiseShare) * P_pose * H * P_pose.topRows<6>();
}

Matrix6d errors_of_all_points() {
  Matrix6d P = Matrix6d::Zero();
  P.diagonal().tail<3>().setConstant(kSharedTurn_rad * kSharedTurn_rad);
  return P;
}

Matrix6d in_base_axes(const Matrix6d& P_odom_base, const Se3& T_odom_base) {
  Matrix6d turn = Matrix6d::Identity();
  turn.topLeftCorner<3, 3>() = T_odom_base.rotation().transpose();
  return turn * P_odom_base * turn.transpose();
}

Matrix6d map_drift(const Matrix6d& information,
                   const Se3& T_odom_base,
                   const Matrix6d& J_base_imu,
                   const Se3& T_last_base,
                   double median_range_m) {
  const double way_m = T_last_base.translation().norm();
  Matrix6d bounded = information;
  bounded.diagonal().head<3>().array() += 1.0 / (kMostLaid_m * kMostLaid_m);
  bounded.diagonal().tail<3>().array() += 1.0 / (kMostLaid_rad * kMostLaid_rad);
  const double laid = kLaidShare * way_m / std::max(kLeastRange_m, median_range_m);
  return in_base_axes(laid * (J_base_imu * bounded.inverse() * J_base_imu.transpose()), T_odom_base);
}

Eigen::Vector3d blind_way(const registration::WeakDirections& weak, const Eigen::Vector3d& step_odom, double share) {
  Eigen::Vector3d blind = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < weak.count; ++i) {
    blind += share * weak.odom[i].dot(step_odom) * weak.odom[i];
  }
  return blind;
}

void SurroundingsDrift::add(const Se3& T_odom_last,
                            const Se3& T_odom_base,
                            const Matrix6d& drift_base,
                            const Eigen::Vector3d& blind_odom) {
  const Se3 T_last_base = T_odom_last.inverse() * T_odom_base;
  const double kept = std::exp(-T_last_base.translation().norm() / kSurroundings_m);
  covariance_ = composed_drift(kept * covariance_, T_odom_last, T_last_base, drift_base);
  blind_odom_ = kept * blind_odom_ + blind_odom;
}

Matrix6d SurroundingsDrift::covariance() const {
  Matrix6d P = covariance_;
  P.topLeftCorner<3, 3>() += blind_odom_ * blind_odom_.transpose();
  return P;
}

}  // namespace slamd::odometry
