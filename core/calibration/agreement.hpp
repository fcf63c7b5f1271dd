#pragma once

#include <array>

namespace slamd::calibration {

/// A quantity as estimated, and its standard deviation.
struct Estimate {
  double value = 0.0;
  double std = 0.0;

  /// Whether it is other than zero beyond doubt (3σ), and by more than `least`.
  bool stands_out(double least) const {
    const double size = value < 0.0 ? -value : value;
    return std > 0.0 && size > 3.0 * std && size > least;
  }
};

/// How LiDAR and inertial sensor go together, as far as a drive has shown it.
/// Frames: rotation in imu.  Units: s, rad.
struct LidarImuAgreement {
  Estimate offset_s;                       // positive: inertial stamps are late
  std::array<Estimate, 3> rotation_rad{};  // about x, y, z of imu, against the configured place
  int windows = 0;                         // of ten seconds each that were looked at
  bool known = false;                      // enough of them, and the offset to a millisecond (1σ)
};

/// How base stands to the vertical in the mean of a drive.
/// Units: rad, m.
struct GravityAgreement {
  Estimate roll_rad;   // of base about its x against the vertical
  Estimate pitch_rad;  // about y
  double way_m = 0.0;
  bool known = false;  // enough of it
};

/// What a drive has shown of the places and clocks in the configuration.
struct SensorAgreement {
  LidarImuAgreement lidar_imu;
  GravityAgreement gravity;
};

}  // namespace slamd::calibration
