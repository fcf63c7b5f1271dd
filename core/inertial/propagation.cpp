#include "core/inertial/propagation.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::inertial {

using geometry::skew;
using geometry::so3_exp;
using geometry::so3_right_jacobian;
using sensor::ImuSample;

namespace {

/// Adds variance to one block of the diagonal.
void add_noise(Covariance& P, int block, double variance) {
  P.diagonal().segment<3>(block).array() += variance;
}

/// Density of the turn's noise: white, and the sensor's scale and misalignment while it turns.  Units: rad²/s.
double turn_variance_density(const Eigen::Vector3d& rate_radps, const ImuNoise& noise) {
  const double scale = noise.gyro_scale_error;
  return noise.gyro_noise_radps_sqrthz * noise.gyro_noise_radps_sqrthz +
         scale * scale * rate_radps.squaredNorm() * noise.turn_error_time_s;
}

/// Calls visit(mean sample, dt_s) for each piece of [from, to] that lies between two neighbouring samples.
template <typename Visit>
void for_each_interval(std::span<const ImuSample> samples, Stamp from, Stamp to, Visit&& visit) {
  Stamp now = from;
  for (std::size_t i = 0; i + 1 < samples.size() && now < to; ++i) {
    const Stamp end = std::min(samples[i + 1].stamp, to);
    if (end <= now) {
      continue;
    }
    const ImuSample a = interpolate(samples[i], samples[i + 1], now);
    const ImuSample b = interpolate(samples[i], samples[i + 1], end);
    visit(mean_of(a, b), to_seconds(end - now));
    now = end;
  }
  if (now < to && !samples.empty()) {
    visit(samples.back(), to_seconds(to - now));
  }
}

}  // namespace

ImuSample mean_of(const ImuSample& a, const ImuSample& b) {
  return {a.stamp + (b.stamp - a.stamp) / 2,
          0.5 * (a.angular_rate_radps + b.angular_rate_radps),
          0.5 * (a.specific_force_mps2 + b.specific_force_mps2)};
}

ImuSample interpolate(const ImuSample& a, const ImuSample& b, Stamp stamp) {
  if (b.stamp <= a.stamp) {
    return a;
  }
  const double ratio = std::clamp(to_seconds(stamp - a.stamp) / to_seconds(b.stamp - a.stamp), 0.0, 1.0);
  return {stamp,
          (1.0 - ratio) * a.angular_rate_radps + ratio * b.angular_rate_radps,
          (1.0 - ratio) * a.specific_force_mps2 + ratio * b.specific_force_mps2};
}

void propagate_mean(NavState& state, const ImuSample& mean, double dt_s) {
  const Eigen::Vector3d turn = (mean.angular_rate_radps - state.gyro_bias) * dt_s;
  const Eigen::Matrix3d& R = state.T_odom_imu.rotation();
  // The specific force is turned by the orientation in the middle of the interval.
  const Eigen::Vector3d acceleration =
      R * (so3_exp(0.5 * turn) * (mean.specific_force_mps2 - state.accel_bias)) + state.g_odom;
  state.T_odom_imu.translation() += state.v_odom_imu * dt_s + 0.5 * dt_s * dt_s * acceleration;
  state.v_odom_imu += acceleration * dt_s;
  state.T_odom_imu.rotation() = geometry::orthonormalized(R * so3_exp(turn));
  state.stamp += from_seconds(dt_s);
}

void propagate_interval(
    NavState& state, Covariance& P, const ImuSample& mean, double dt_s, const ImuNoise& noise, Followers* followers) {
  const Eigen::Vector3d turn = (mean.angular_rate_radps - state.gyro_bias) * dt_s;
  const Eigen::Vector3d force = mean.specific_force_mps2 - state.accel_bias;
  const Eigen::Matrix3d R = state.T_odom_imu.rotation();

  Covariance F = Covariance::Identity();
  F.block<3, 3>(kPosition, kVelocity).diagonal().setConstant(dt_s);
  F.block<3, 3>(kPosition, kRotation) = -0.5 * dt_s * dt_s * R * skew(force);
  F.block<3, 3>(kPosition, kAccelBias) = -0.5 * dt_s * dt_s * R;
  F.block<3, 3>(kRotation, kRotation) = so3_exp(-turn);
  F.block<3, 3>(kRotation, kGyroBias) = -dt_s * so3_right_jacobian(turn);
  F.block<3, 3>(kVelocity, kRotation) = -dt_s * R * skew(force);
  F.block<3, 3>(kVelocity, kAccelBias) = -dt_s * R;
  F.block<3, 2>(kVelocity, kGravity) = -dt_s * skew(state.g_odom) * tangent_basis(state.g_odom);

  Covariance FP;
  FP.noalias() = F * P;
  P.noalias() = FP * F.transpose();
  if (followers != nullptr) {
    *followers = (F * *followers).eval();
  }
  add_noise(P, kRotation, turn_variance_density(mean.angular_rate_radps - state.gyro_bias, noise) * dt_s);
  add_noise(P, kVelocity, noise.accel_noise_mps2_sqrthz * noise.accel_noise_mps2_sqrthz * dt_s);
  add_noise(P, kGyroBias, noise.gyro_bias_walk_radps2_sqrthz * noise.gyro_bias_walk_radps2_sqrthz * dt_s);
  add_noise(P, kAccelBias, noise.accel_bias_walk_mps3_sqrthz * noise.accel_bias_walk_mps3_sqrthz * dt_s);
  propagate_mean(state, mean, dt_s);
}

void propagate(
    NavState& state, Covariance& P, std::span<const ImuSample> samples, Stamp to, const ImuNoise& noise,
    Followers* followers) {
  for_each_interval(samples, state.stamp, to, [&](const ImuSample& mean, double dt_s) {
    propagate_interval(state, P, mean, dt_s, noise, followers);
  });
  P = (0.5 * (P + P.transpose())).eval();
  state.stamp = to;
}

void propagate_constant_velocity(NavState& state,
                                 Covariance& P,
                                 Stamp to,
                                 const ConstantVelocityNoise& noise,
                                 Followers* followers) {
  const double dt_s = to_seconds(to - state.stamp);
  const Eigen::Vector3d turn = -state.gyro_bias * dt_s;

  Covariance F = Covariance::Identity();
  F.block<3, 3>(kPosition, kVelocity).diagonal().setConstant(dt_s);
  F.block<3, 3>(kRotation, kRotation) = so3_exp(-turn);
  F.block<3, 3>(kRotation, kGyroBias) = -dt_s * so3_right_jacobian(turn);

  Covariance FP;
  FP.noalias() = F * P;
  P.noalias() = FP * F.transpose();
  if (followers != nullptr) {
    *followers = (F * *followers).eval();
  }
  // White acceleration through a double integrator; the cross terms keep velocity observable from position.
  const double q_v = noise.acceleration_mps2_sqrthz * noise.acceleration_mps2_sqrthz;
  const double q_w = noise.angular_acceleration_radps2_sqrthz * noise.angular_acceleration_radps2_sqrthz;
  add_noise(P, kPosition, q_v * dt_s * dt_s * dt_s / 3.0);
  add_noise(P, kVelocity, q_v * dt_s);
  add_noise(P, kRotation, q_w * dt_s * dt_s * dt_s / 3.0);
  add_noise(P, kGyroBias, q_w * dt_s);
  for (int axis = 0; axis < 3; ++axis) {
    P(kPosition + axis, kVelocity + axis) += q_v * dt_s * dt_s / 2.0;
    P(kVelocity + axis, kPosition + axis) += q_v * dt_s * dt_s / 2.0;
    P(kRotation + axis, kGyroBias + axis) -= q_w * dt_s * dt_s / 2.0;
    P(kGyroBias + axis, kRotation + axis) -= q_w * dt_s * dt_s / 2.0;
  }
  state.T_odom_imu.translation() += state.v_odom_imu * dt_s;
  state.T_odom_imu.rotation() = geometry::orthonormalized(state.T_odom_imu.rotation() * so3_exp(turn));
  state.stamp = to;
}

void propagate_unseen(NavState& state, Covariance& P, Stamp to, const UnseenMotion& motion, Followers* followers) {
  const double dt_s = to_seconds(to - state.stamp);
  if (dt_s <= 0.0) {
    return;
  }
  const auto forget = [&](int block) {
    P.middleRows<3>(block).setZero();
    P.middleCols<3>(block).setZero();
    if (followers != nullptr) {
      followers->middleRows<3>(block).setZero();
    }
  };
  const double way_m = motion.speed_mps * dt_s;
  add_noise(P, kPosition, way_m * way_m);
  // Turns are about imu's axes, the heading is about odom's vertical.
  const Eigen::Vector3d up_imu = -(state.T_odom_imu.rotation().transpose() * state.g_odom).normalized();
  P.block<3, 3>(kRotation, kRotation) += motion.tilt_rad * motion.tilt_rad * Eigen::Matrix3d::Identity() +
                                         motion.turn_rad * motion.turn_rad * up_imu * up_imu.transpose();
  forget(kVelocity);
  state.v_odom_imu.setZero();
  add_noise(P, kVelocity, motion.speed_mps * motion.speed_mps);
  state.stamp = to;
}

}  // namespace slamd::inertial
