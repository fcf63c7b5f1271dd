#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry/se3.hpp"
#include "core/inertial/nav_state.hpp"
#include "core/sensor/wheel_sample.hpp"

namespace slamd::inertial {

/// How wheels are believed.
struct WheelConfig {
  double speed_std_mps = 0.02;       // of one sample
  double speed_share = 0.02;         // and of its speed
  double sideways_std_mps = 0.10;    // what a vehicle on wheels does not do, standing or straight
  double sideways_per_turn_m = 0.5;  // and in a turn: skid, and base that is not on the axle
  double vertical_std_mps = 0.20;
  double turn_std_radps = 0.05;      // used only without a gyroscope
  double turn_share = 0.2;
  double scale_std = 0.03;           // of the wheels' size, at first
  double scale_walk_sqrts = 2e-4;
  double slip_gate_sq = 9.0;         // squared Mahalanobis length of a speed; beyond, the wheels slip
};

/// What happened to the samples.
struct WheelCounts {
  std::uint64_t used = 0;
  std::uint64_t slipped = 0;
};

/// Updates the state with wheel odometry, and estimates the wheels' scale with it.
///
/// The scale is an eighteenth error state of this filter alone: its covariance with the 17 others lives here, goes
/// through each propagation and each update with them, and so learns from the LiDAR where that sees the way, and serves
/// where it does not. The transition of all 18 goes the same ways.
/// Source: EKF with the state augmented by a calibration parameter; gate on the normalised innovation.
/// Real-time: no allocation; O(17²) a sample.
class WheelUpdate {
 public:
  explicit WheelUpdate(const WheelConfig& config) : config_(config), scale_variance_(config.scale_std * config.scale_std) {}

  /// Takes in a sample at the state's stamp. `rate_imu_radps` is the turn rate without its bias; `by_gyro` tells that it
  /// was measured: otherwise gyro_bias holds −ω and the wheels' turn rate helps to find it.
  /// Returns false when the wheels slip: the sample's speed is then left out.
  bool update(const sensor::WheelSample& sample,
              const geometry::Se3& T_base_imu,
              const Eigen::Vector3d& rate_imu_radps,
              bool by_gyro,
              NavState& state,
              Covariance& P);

  /// What is to be carried through each propagation.
  Followers& followers() { return followers_; }

  /// From here on transition() counts.
  void begin_transition();

  /// How the errors of the 17 states and of the scale live on since begin_transition.
  Transition transition() const;

  /// Takes in what another measurement has said of the states: from the prior to the posterior.
  void follow(const NavState& prior, const Covariance& P_prior, const NavState& posterior, const Covariance& P_posterior);

  /// Forgets how the scale, and earlier errors, hang together with some of the states, which are set anew.
  void separate(int block, int size) { followers_.middleRows(block, size).setZero(); }

  /// The covariance of the scale with the error states.
  ErrorState cross() const { return followers_.col(0); }

  double scale_variance() const { return scale_variance_; }

  double scale() const { return scale_; }
  double scale_std() const { return std::sqrt(scale_variance_); }
  const WheelCounts& counts() const { return counts_; }

 private:
  struct Measurement {
    ErrorState h = ErrorState::Zero();  // of the measured quantity by the error states
    double h_scale = 0.0;
    double residual = 0.0;
    double variance = 1.0;
  };

  double innovation_variance(const Measurement& measurement, const Covariance& P) const;
  void apply(const Measurement& measurement, NavState& state, Covariance& P);

  WheelConfig config_;
  double scale_ = 1.0;  // true speed by the wheels'
  double scale_variance_;
  Followers followers_ = Followers::Zero();
  Eigen::Matrix<double, 1, kFilterStates> scale_row_ = Eigen::Matrix<double, 1, kFilterStates>::Zero();  // of the transition
  Stamp last_{};
  WheelCounts counts_;
};

}  // namespace slamd::inertial
