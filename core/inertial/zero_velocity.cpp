#include "core/inertial/zero_velocity.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace slamd::inertial {

using sensor::ImuSample;
using sensor::WheelSample;

namespace {

template <typename Get>
Eigen::Vector3d mean_of(std::span<const ImuSample> samples, Get&& get) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) {
    sum += get(sample);
  }
  return sum / static_cast<double>(samples.size());
}

/// The largest standard deviation of an axis.
template <typename Get>
double spread_of(std::span<const ImuSample> samples, Get&& get) {
  const Eigen::Vector3d mean = mean_of(samples, get);
  Eigen::Vector3d square_sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) {
    square_sum += (get(sample) - mean).cwiseAbs2();
  }
  return std::sqrt(square_sum.maxCoeff() / static_cast<double>(samples.size()));
}

Eigen::Vector3d rate_of(const ImuSample& sample) { return sample.angular_rate_radps; }
Eigen::Vector3d force_of(const ImuSample& sample) { return sample.specific_force_mps2; }

}  // namespace

bool ZeroVelocityUpdate::is_still(std::span<const ImuSample> samples, std::span<const WheelSample> wheels) const {
  const bool wheels_stand = std::all_of(wheels.begin(), wheels.end(), [&](const WheelSample& wheel) {
    return std::abs(wheel.speed_mps) < config_.wheels_below_mps && std::abs(wheel.turn_rate_radps) < config_.wheels_below_radps;
  });
  if (samples.empty()) {
    return wheels_stand && !wheels.empty();
  }
  return wheels_stand && samples.size() >= config_.min_samples && spread_of(samples, rate_of) < config_.gyro_std_radps &&
         spread_of(samples, force_of) < config_.accel_std_mps2;
}

/// Of a mean turn rate: white noise, and what rest leaves.
double ZeroVelocityUpdate::rate_variance_of(std::span<const ImuSample> samples, const ImuNoise& noise) const {
  const double span_s = std::max(1e-3, to_seconds(samples.back().stamp - samples.front().stamp));
  return noise.gyro_noise_radps_sqrthz * noise.gyro_noise_radps_sqrthz / span_s + config_.rate_std_radps * config_.rate_std_radps;
}

bool ZeroVelocityUpdate::update(std::span<const ImuSample> samples,
                                std::span<const WheelSample> wheels,
                                const ImuNoise& noise,
                                NavState& state,
                                Covariance& P) {
  if (!is_still(samples, wheels)) {
    return false;
  }
  const double speed_std_mps = std::sqrt(P.diagonal().segment<3>(kVelocity).maxCoeff());
  const double sure_mps = is_held_ || !wheels.empty() ? config_.sure_below_mps : config_.begin_below_mps;
  if (!samples.empty() && !(state.v_odom_imu.norm() + 2.0 * speed_std_mps <= sure_mps)) {
    return false;
  }
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  // Velocity and gyroscope's bias are neighbours among the error states: H picks these six.
  static_assert(kGyroBias == kVelocity + 3);
  Vector6 residual;
  // Without a gyroscope its bias holds −ω.
  const Eigen::Vector3d rate_radps = samples.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : mean_of(samples, rate_of);
  residual << -state.v_odom_imu, rate_radps - state.gyro_bias;
  const double rate_variance = samples.empty() ? config_.wheels_below_radps * config_.wheels_below_radps : rate_variance_of(samples, noise);
  Matrix6 S = P.block<6, 6>(kVelocity, kVelocity);
  S.diagonal().head<3>().array() += config_.speed_std_mps * config_.speed_std_mps;
  S.diagonal().tail<3>().array() += rate_variance;
  const Eigen::LDLT<Matrix6> solver(S);
  if (!(residual.dot(solver.solve(residual)) <= config_.gate_sq)) {
    return false;
  }
  const Eigen::Matrix<double, kErrorStates, 6> PHt = P.middleCols<6>(kVelocity);
  const Eigen::Matrix<double, kErrorStates, 6> gain = solver.solve(PHt.transpose()).transpose();
  state = boxplus(state, ErrorState(gain * residual));
  P.noalias() -= gain * PHt.transpose();
  P = (0.5 * (P + P.transpose())).eval();
  is_held_ = true;
  return true;
}

}  // namespace slamd::inertial
