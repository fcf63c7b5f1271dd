#include "core/inertial/wheel_update.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/geometry/so3.hpp"

namespace slamd::inertial {

using geometry::Se3;
using sensor::WheelSample;

double WheelUpdate::innovation_variance(const Measurement& m, const Covariance& P) const {
  return m.h.dot(P * m.h) + 2.0 * m.h_scale * m.h.dot(cross()) + m.h_scale * m.h_scale * scale_variance_ + m.variance;
}

void WheelUpdate::apply(const Measurement& m, NavState& state, Covariance& P) {
  const double S = innovation_variance(m, P);
  const ErrorState gain = (P * m.h + m.h_scale * cross()) / S;
  const double gain_scale = (m.h.dot(cross()) + m.h_scale * scale_variance_) / S;
  state = boxplus(state, ErrorState(gain * m.residual));
  scale_ += gain_scale * m.residual;
  const Eigen::Matrix<double, 1, kFilterStates> seen =
      m.h.transpose() * followers_.rightCols<kFilterStates>() + m.h_scale * scale_row_;
  followers_.rightCols<kFilterStates>().noalias() -= gain * seen;
  scale_row_ -= gain_scale * seen;
  P.noalias() -= S * gain * gain.transpose();
  followers_.col(0) -= S * gain_scale * gain;
  scale_variance_ = std::max(1e-10, scale_variance_ - S * gain_scale * gain_scale);
}

bool WheelUpdate::update(const WheelSample& sample,
                         const Se3& T_base_imu,
                         const Eigen::Vector3d& rate_imu_radps,
                         bool by_gyro,
                         NavState& state,
                         Covariance& P) {
  if (last_ != Stamp{}) {
    scale_variance_ += config_.scale_walk_sqrts * config_.scale_walk_sqrts * std::max(0.0, to_seconds(sample.stamp - last_));
  }
  last_ = sample.stamp;
  const Eigen::Matrix3d R_base_imu = T_base_imu.rotation();
  const Eigen::Vector3d lever_base = R_base_imu * rate_imu_radps.cross(T_base_imu.inverse().translation());
  const double turn_radps = std::abs((R_base_imu * rate_imu_radps).z());
  // The velocity of base along one of its own axes, and what it depends on.
  const auto velocity_along = [&](int axis, double measured_mps, double std_mps) {
    const Eigen::Matrix3d R_imu_odom = state.T_odom_imu.rotation().transpose();
    const Eigen::Vector3d v_imu = R_imu_odom * state.v_odom_imu;
    Measurement m;
    m.h.segment<3>(kVelocity) = (R_base_imu.row(axis) * R_imu_odom).transpose();
    m.h.segment<3>(kRotation) = (R_base_imu.row(axis) * geometry::skew(v_imu)).transpose();
    m.residual = measured_mps - R_base_imu.row(axis).dot(v_imu) - lever_base[axis];
    m.variance = std_mps * std_mps;
    return m;
  };
  Measurement ahead = velocity_along(0, scale_ * sample.speed_mps,
                                     config_.speed_std_mps + config_.speed_share * std::abs(sample.speed_mps));
  ahead.h_scale = -sample.speed_mps;
  const bool slips = ahead.residual * ahead.residual > config_.slip_gate_sq * innovation_variance(ahead, P);
  if (slips) {
    ++counts_.slipped;
  } else {
    apply(ahead, state, P);
    ++counts_.used;
  }
  apply(velocity_along(1, 0.0, config_.sideways_std_mps + config_.sideways_per_turn_m * turn_radps), state, P);
  apply(velocity_along(2, 0.0, config_.vertical_std_mps), state, P);
  if (!by_gyro && !slips) {
    Measurement turn;
    turn.h.segment<3>(kGyroBias) = -R_base_imu.row(2).transpose();
    turn.residual = sample.turn_rate_radps + R_base_imu.row(2).dot(state.gyro_bias);
    const double std_radps = config_.turn_std_radps + config_.turn_share * std::abs(sample.turn_rate_radps);
    turn.variance = std_radps * std_radps;
    apply(turn, state, P);
  }
  P = (0.5 * (P + P.transpose())).eval();
  return !slips;
}

void WheelUpdate::follow(const NavState& prior,
                         const Covariance& P_prior,
                         const NavState& posterior,
                         const Covariance& P_posterior) {
  const Followers regression = P_prior.ldlt().solve(followers_);
  const ErrorState of_scale = regression.col(0);
  scale_ += of_scale.dot(boxminus(posterior, prior));
  scale_variance_ = std::max(1e-10, scale_variance_ - of_scale.dot((P_prior - P_posterior) * of_scale));
  const Followers before = followers_;
  followers_.noalias() = P_posterior * regression;
  scale_row_ += of_scale.transpose() * (followers_ - before).rightCols<kFilterStates>();
}

void WheelUpdate::begin_transition() {
  followers_.rightCols<kFilterStates>().setIdentity();
  scale_row_.setZero();
  scale_row_[kErrorStates] = 1.0;
}

Transition WheelUpdate::transition() const {
  Transition transition;
  transition << followers_.rightCols<kFilterStates>(), scale_row_;
  return transition;
}

}  // namespace slamd::inertial
