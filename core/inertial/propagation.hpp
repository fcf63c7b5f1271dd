#pragma once

#include <span>

#include "core/inertial/nav_state.hpp"
#include "core/sensor/imu_sample.hpp"

namespace slamd::inertial {

/// Continuous-time noise of the inertial sensor. The defaults are those of a consumer MEMS part on a vehicle.
struct ImuNoise {
  double gyro_noise_radps_sqrthz = 1.0e-3;
  double accel_noise_mps2_sqrthz = 1.0e-2;
  double gyro_bias_walk_radps2_sqrthz = 1.0e-5;
  double accel_bias_walk_mps3_sqrthz = 3.0e-4;
  /// Scale error and misalignment against the LiDAR, as a share of the turn rate: what a turn leaves behind, whatever
  /// the white noise. They keep their sign: t after a scan has corrected it the orientation is wrong by the share times the
  /// turn, (e ω t)². From t0 to t1 that is white noise of density e² ω² (t0 + t1), whose sum of times stands here.
  double gyro_scale_error = 5.0e-3;
  double turn_error_time_s = 0.1;

  /// The same noise for a step from t0 to t1 after the last correction.
  ImuNoise between(Duration t0, Duration t1) const {
    ImuNoise noise = *this;
    noise.turn_error_time_s = to_seconds(t0 + t1);
    return noise;
  }
};

/// Noise of the constant-velocity model that stands in where there is no inertial sensor.
struct ConstantVelocityNoise {
  double acceleration_mps2_sqrthz = 2.0;
  double angular_acceleration_radps2_sqrthz = 1.5;
};

/// Moves the state and its covariance over one interval with the mean of the samples at both ends, and with them what
/// follows them, where given.
/// Source: error-state propagation after Sola, "Quaternion kinematics for the error-state Kalman filter", 5.4,
/// with gravity on S² as in FAST-LIO2.  Real-time: no allocation; O(17³).
void propagate_interval(NavState& state,
                        Covariance& P,
                        const sensor::ImuSample& mean,
                        double dt_s,
                        const ImuNoise& noise,
                        Followers* followers = nullptr);

/// Moves only the state, as propagate_interval does.
void propagate_mean(NavState& state, const sensor::ImuSample& mean, double dt_s);

/// Moves the state and its covariance from its stamp to `to`.
/// `samples` bracket the interval: the first at or before state.stamp, the last at or after `to`, or the nearest
/// there are; beyond the last sample its rates are held.
/// Real-time: no allocation; O(samples · 17³).
void propagate(NavState& state,
               Covariance& P,
               std::span<const sensor::ImuSample> samples,
               Stamp to,
               const ImuNoise& noise,
               Followers* followers = nullptr);

/// Moves a state without inertial samples at constant velocity. Here gyro_bias holds −ω (a gyroscope that always
/// reads zero is wrong by just that), so that the filter estimates the turn rate with the state it has.
void propagate_constant_velocity(NavState& state, Covariance& P, Stamp to, const ConstantVelocityNoise& noise,
                                 Followers* followers = nullptr);

/// Longer than this no two samples say what was between them.
inline constexpr Duration kLongestBridge = std::chrono::seconds(3);

/// What a vehicle may do that nobody watches.
struct UnseenMotion {
  double speed_mps = 1.0;          // 1σ of its mean velocity, an axis: a walking pace
  double turn_rad = 3.0;           // 1σ of its heading
  double tilt_rad = 0.05;          // and of roll and pitch: other ground
};

/// Moves a state over a time of which no sensor tells anything: it stays where it is, and the covariance says what that
/// is worth. The velocity is forgotten, the biases stay.
void propagate_unseen(NavState& state, Covariance& P, Stamp to, const UnseenMotion& motion, Followers* followers = nullptr);

/// Returns the mean of two samples, which stands for the interval between them.
sensor::ImuSample mean_of(const sensor::ImuSample& a, const sensor::ImuSample& b);

/// Returns the sample at a stamp between a and b by linear interpolation; clamped to the two.
sensor::ImuSample interpolate(const sensor::ImuSample& a, const sensor::ImuSample& b, Stamp stamp);

}  // namespace slamd::inertial
