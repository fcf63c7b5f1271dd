#pragma once

#include <cstddef>
#include <optional>

#include "core/inertial/nav_state.hpp"
#include "core/sensor/imu_sample.hpp"

namespace slamd::inertial {

/// How the first state is found.
struct StartUpConfig {
  Duration static_window = std::chrono::milliseconds(1000);   // at rest this long: aligned
  Duration patience = std::chrono::milliseconds(3000);        // then a moving start is taken
  double static_gyro_std_radps = 0.02;
  double static_accel_std_mps2 = 0.35;
  double accel_bias_std_mps2 = 0.15;    // horizontal, what a static start cannot see
  double moving_tilt_std_rad = 0.06;
  double moving_velocity_std_mps = 1.5;
};

/// The filter's first state. odom is levelled here, once, and never again.
struct Alignment {
  NavState state;
  Covariance P = Covariance::Identity();
  bool at_rest = true;
  double tilt_std_rad = 0.0;  // what levelling may be wrong by: from the accelerometer's unknown bias
};

/// Gives a moving start the wheels' speed: base goes straight ahead.  Without it the first scans would be deskewed, and
/// laid into the map, as if at rest.
Alignment with_wheel_speed(const Alignment& alignment, double speed_mps, const geometry::Se3& T_base_imu);

/// Levels odom and finds the gyroscope's bias from the first seconds of inertial samples.
///
/// At rest the mean specific force is gravity plus an unknown accelerometer bias. odom's vertical is set along it,
/// and the covariance couples the gravity direction and the bias, so that both stay consistent ("at rest" stays
/// predicted) until motion tells them apart.
/// Real-time: no allocation; constant time per sample.
class StartUpAlignment {
 public:
  explicit StartUpAlignment(const StartUpConfig& config) : config_(config) {}

  /// Adds a sample; returns the alignment once it is known, stamped with that sample.
  /// T_base_imu places odom's origin at base and its x axis along base's.
  std::optional<Alignment> add(const sensor::ImuSample& sample, const geometry::Se3& T_base_imu);

  /// Says that the wheels turn: whatever the samples look like, this window is not at rest. A steady acceleration looks
  /// like a slope.
  void note_moving() { moving_ = true; }

  /// True while the samples so far look like standing still.
  bool at_rest() const;

 private:
  void restart_window(const sensor::ImuSample& sample);
  Alignment align(Stamp stamp, const geometry::Se3& T_base_imu, bool at_rest) const;

  StartUpConfig config_;
  std::optional<Stamp> first_;
  Stamp window_begin_{};
  std::size_t count_ = 0;
  bool moving_ = false;  // in this window
  Eigen::Vector3d gyro_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_square_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_square_sum_ = Eigen::Vector3d::Zero();
};

}  // namespace slamd::inertial
