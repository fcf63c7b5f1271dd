#include "daemon/stages/pose_stage.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/geometry/so3.hpp"
#include "core/inertial/propagation.hpp"
#include "daemon/stages/preprocess_stage.hpp"

namespace slamd::stages {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;
using inertial::NavState;
using sensor::ImuSample;

namespace {

/// χ² of six degrees of freedom that 3σ of a single one corresponds to (99.73 %).
constexpr double kThreeSigma_sq = 20.06;

}  // namespace

PoseStage::PoseStage(const odometry::OdometryConfig& config, Duration blend)
    : config_(config), blend_(blend), imu_(sensor::ImuBufferConfig{}) {}

void PoseStage::add_anchor(const Anchor& anchor) {
  const bool first = !has_anchor_;
  const bool begins_anew = !first && anchor.epoch != anchor_.epoch;
  reset_counter_ += begins_anew ? 1 : 0;
  const NavState shown_before = blended(state_);
  has_anchor_ = true;
  reset_counter_ += anchor.map_restarts - anchor_.map_restarts;
  anchor_ = anchor;
  imu_.drop_before(anchor.state.stamp);
  const Matrix6d P_before = P_.block<6, 6>(inertial::kPosition, inertial::kPosition);
  state_ = anchor.state;
  P_ = anchor.P;
  if (!imu_.empty() && config_.use_imu) {
    const auto samples = imu_.samples();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      advance(samples[i > 0 ? i - 1 : 0], samples[i]);
    }
  }
  if (first || begins_anew || shown_before.stamp < state_.stamp) {
    // Nothing was shown at this time yet, as without an inertial sensor: compare where both are, at the anchor.
    // Or what was shown lay in another odom.
    pending_.setZero();
    pending_velocity_.setZero();
    blend_begin_ = state_.stamp;
    return;
  }
  const Vector6d change = geometry::boxminus(shown_before.T_odom_imu, state_.T_odom_imu);
  const bool large = change.head<3>().norm() > kLargeCorrection_m ||
                     change.dot(P_before.ldlt().solve(change)) > kThreeSigma_sq;
  reset_counter_ += large ? 1 : 0;
  pending_ = large ? Vector6d(Vector6d::Zero()) : change;
  pending_velocity_ = large ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                            : Eigen::Vector3d(shown_before.v_odom_imu - state_.v_odom_imu);
  blend_begin_ = state_.stamp;
}

void PoseStage::advance(const ImuSample& before, const ImuSample& after) {
  const Stamp from = std::max(before.stamp, state_.stamp);
  if (after.stamp - from > inertial::kLongestBridge) {
    inertial::propagate_unseen(state_, P_, after.stamp, config_.unseen);
  } else if (after.stamp > state_.stamp) {
    const ImuSample first = inertial::interpolate(before, after, from);
    inertial::propagate_interval(state_, P_, inertial::mean_of(first, after), to_seconds(after.stamp - state_.stamp),
                                 config_.imu_noise.between(from - anchor_.state.stamp, after.stamp - anchor_.state.stamp));
    state_.stamp = after.stamp;
  }
}

std::optional<PredictedPose> PoseStage::add_imu(ImuSample sample) {
  sample.stamp -= config_.imu_offset;
  const bool had_one = !imu_.empty();
  const ImuSample before = had_one ? imu_.newest() : sample;
  if (!imu_.push(sample) || !has_anchor_) {
    return std::nullopt;
  }
  advance(before, sample);
  return shown(blended(state_), sample.angular_rate_radps - state_.gyro_bias);
}

std::optional<PredictedPose> PoseStage::at_anchor() const {
  if (!has_anchor_) {
    return std::nullopt;
  }
  const Eigen::Vector3d rate = config_.use_imu && !imu_.empty() ? Eigen::Vector3d(imu_.newest().angular_rate_radps - state_.gyro_bias)
                                                               : Eigen::Vector3d(-anchor_.state.gyro_bias);
  return shown(blended(state_), rate);
}

NavState PoseStage::blended(const NavState& state) const {
  NavState result = state;
  const double share = 1.0 - to_seconds(state.stamp - blend_begin_) / to_seconds(blend_);
  if (share > 0.0) {
    result.T_odom_imu = geometry::boxplus(state.T_odom_imu, Vector6d(share * pending_));
    result.v_odom_imu += share * pending_velocity_;
  }
  return result;
}

PredictedPose PoseStage::shown(const NavState& state, const Eigen::Vector3d& rate_imu_radps) const {
  PredictedPose pose;
  pose.stamp = state.stamp;
  const Se3 T_imu_base = config_.T_base_imu.inverse();
  pose.T_odom_base = state.T_odom_imu * T_imu_base;
  const Eigen::Matrix3d& R_odom_imu = state.T_odom_imu.rotation();
  pose.v_odom_base = state.v_odom_imu + R_odom_imu * rate_imu_radps.cross(T_imu_base.translation());
  pose.rate_base_radps = config_.T_base_imu.rotation() * rate_imu_radps;
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -R_odom_imu * geometry::skew(T_imu_base.translation());
  J.bottomRightCorner<3, 3>() = config_.T_base_imu.rotation();
  pose.P_odom_base =
      J * P_.block<6, 6>(inertial::kPosition, inertial::kPosition) * J.transpose() + anchor_.shared_errors;
  pose.P_velocity_odom = P_.block<3, 3>(inertial::kVelocity, inertial::kVelocity);
  pose.reset_counter = reset_counter_;
  pose.state = anchor_.odometry_state;
  pose.cause = anchor_.cause;
  if (state.stamp - anchor_.state.stamp > kNoScan) {
    pose.state = pose.state == odometry::State::kTracking ? odometry::State::kDegraded : pose.state;
    pose.cause = odometry::Cause::kNoLidar;
  }
  pose.weak_axes = anchor_.weak_axes;
  return pose;
}

}  // namespace slamd::stages
