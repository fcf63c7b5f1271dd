#include "core/inertial/start_up_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::inertial {

using geometry::Se3;

namespace {

/// Fewer samples say nothing about their spread.
constexpr std::size_t kMinSamples = 20;

/// By how much a vehicle's velocity may differ from its wheels' at the start: acceleration, slip, a lever in a turn.
constexpr double kWheelStart_mps = 0.3;

double largest_std(const Eigen::Vector3d& sum, const Eigen::Vector3d& square_sum, std::size_t count) {
  const double n = static_cast<double>(count);
  const Eigen::Vector3d mean = sum / n;
  const Eigen::Vector3d variance = square_sum / n - mean.cwiseAbs2();
  return std::sqrt(std::max(0.0, variance.maxCoeff()));
}

/// Rotation that levels: takes `up_imu` to the z axis of odom and base's x axis into odom's x–z half plane.
Eigen::Matrix3d levelled(const Eigen::Vector3d& up_imu, const Eigen::Matrix3d& R_base_imu) {
  const Eigen::Vector3d up_base = (R_base_imu * up_imu).normalized();
  const Eigen::Matrix3d R_level_base = geometry::rotation_between(up_base, Eigen::Vector3d::UnitZ());
  const double yaw = geometry::rpy_from_rotation(R_level_base).z();
  return geometry::rotation_from_rpy({0.0, 0.0, -yaw}) * R_level_base * R_base_imu;
}

}  // namespace

Alignment with_wheel_speed(const Alignment& alignment, double speed_mps, const Se3& T_base_imu) {
  Alignment result = alignment;
  const Eigen::Matrix3d R_odom_base = alignment.state.T_odom_imu.rotation() * T_base_imu.rotation().transpose();
  result.state.v_odom_imu = speed_mps * R_odom_base.col(0);
  result.P.diagonal().segment<3>(kVelocity).setConstant(kWheelStart_mps * kWheelStart_mps);
  return result;
}

bool StartUpAlignment::at_rest() const {
  return !moving_ && count_ >= kMinSamples &&
         largest_std(gyro_sum_, gyro_square_sum_, count_) < config_.static_gyro_std_radps &&
         largest_std(accel_sum_, accel_square_sum_, count_) < config_.static_accel_std_mps2;
}

void StartUpAlignment::restart_window(const sensor::ImuSample& sample) {
  window_begin_ = sample.stamp;
  count_ = 0;
  moving_ = false;
  gyro_sum_.setZero();
  gyro_square_sum_.setZero();
  accel_sum_.setZero();
  accel_square_sum_.setZero();
}

std::optional<Alignment> StartUpAlignment::add(const sensor::ImuSample& sample, const Se3& T_base_imu) {
  if (!first_) {
    first_ = sample.stamp;
    restart_window(sample);
  }
  ++count_;
  gyro_sum_ += sample.angular_rate_radps;
  gyro_square_sum_ += sample.angular_rate_radps.cwiseAbs2();
  accel_sum_ += sample.specific_force_mps2;
  accel_square_sum_ += sample.specific_force_mps2.cwiseAbs2();

  const bool impatient = sample.stamp - *first_ >= config_.patience;
  if (sample.stamp - window_begin_ < config_.static_window) {
    return std::nullopt;
  }
  if (at_rest()) {
    return align(sample.stamp, T_base_imu, true);
  }
  if (impatient) {
    return align(sample.stamp, T_base_imu, false);
  }
  restart_window(sample);
  return std::nullopt;
}

Alignment StartUpAlignment::align(Stamp stamp, const Se3& T_base_imu, bool at_rest) const {
  const double n = static_cast<double>(count_);
  const Eigen::Vector3d force_imu = accel_sum_ / n;
  const Eigen::Vector3d up_imu = force_imu.normalized();

  Alignment result;
  result.at_rest = at_rest;
  NavState& state = result.state;
  state.stamp = stamp;
  const Eigen::Matrix3d R_odom_imu = levelled(up_imu, T_base_imu.rotation());
  const Eigen::Matrix3d R_odom_base = R_odom_imu * T_base_imu.rotation().transpose();
  state.T_odom_imu = Se3(R_odom_imu, R_odom_base * T_base_imu.translation());  // base at odom's origin
  if (at_rest) {
    state.gyro_bias = gyro_sum_ / n;
    state.accel_bias = (force_imu.norm() - kGravityMps2) * up_imu;
  }

  const double gyro_std = at_rest ? 0.002 : 0.01;
  const double accel_std = config_.accel_bias_std_mps2;
  Covariance& P = result.P;
  P.setZero();
  P.diagonal().segment<3>(kPosition).setConstant(1e-8);
  P.diagonal().segment<3>(kRotation).setConstant(1e-8);  // odom's axes are defined by this very orientation
  P.diagonal().segment<3>(kVelocity).setConstant(
      at_rest ? 1e-4 : config_.moving_velocity_std_mps * config_.moving_velocity_std_mps);
  P.diagonal().segment<3>(kGyroBias).setConstant(gyro_std * gyro_std);
  // Horizontal bias: unknown. Along gravity: seen at rest, but for the local value of gravity itself.
  const Eigen::Matrix3d along = up_imu * up_imu.transpose();
  P.block<3, 3>(kAccelBias, kAccelBias) =
      accel_std * accel_std * (Eigen::Matrix3d::Identity() - along) + 0.02 * 0.02 * along;
  // At rest: -g_odom = R (f - b_a), so δg follows δb_a: dg = -[g]x B δg = R δb_a.
  const Eigen::Matrix<double, 3, 2> J =
      -geometry::skew(state.g_odom) * tangent_basis(state.g_odom);
  const Eigen::Matrix<double, 2, 3> g_from_bias =
      J.transpose() * R_odom_imu / (kGravityMps2 * kGravityMps2);
  P.block<2, 3>(kGravity, kAccelBias) = g_from_bias * P.block<3, 3>(kAccelBias, kAccelBias);
  P.block<3, 2>(kAccelBias, kGravity) = P.block<2, 3>(kGravity, kAccelBias).transpose();
  P.block<2, 2>(kGravity, kGravity) =
      g_from_bias * P.block<3, 3>(kAccelBias, kAccelBias) * g_from_bias.transpose();
  const double extra_tilt_std = at_rest ? 0.0005 : config_.moving_tilt_std_rad;
  P.diagonal().segment<2>(kGravity).array() += extra_tilt_std * extra_tilt_std;
  result.tilt_std_rad = std::sqrt(P.diagonal().segment<2>(kGravity).maxCoeff());
  return result;
}

}  // namespace slamd::inertial
