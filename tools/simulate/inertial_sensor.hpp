#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/se3.hpp"
#include "tools/simulate/motion.hpp"
#include "tools/simulate/noise.hpp"

namespace slamd::simulate {

/// How an inertial sensor errs: a consumer MEMS part (BMI088 class), powered up not long ago.
struct InertialErrors {
  double gyro_noise_radps_sqrthz = 2.44e-4;
  double accel_noise_mps2_sqrthz = 1.72e-3;
  double gyro_bias_radps = 0.0035;      // at switch-on, 1σ an axis
  double accel_bias_mps2 = 0.07;        // at switch-on, 1σ an axis
  double gyro_walk_radps2_sqrthz = 1e-5;
  double accel_walk_mps3_sqrthz = 1e-4;
  double scale = 0.002;                 // 1σ an axis
  double misalignment_rad = 0.0017;     // 1σ an axis, of the whole sensor
  double gyro_step_radps = 2.66e-4;     // quantisation
  double accel_step_mps2 = 1.8e-3;
  double gyro_limit_radps = 34.9;       // 2000 °/s
  double accel_limit_mps2 = 156.9;      // 16 g
  double gyro_per_degree_radps = 0.0;   // bias over temperature, 1σ an axis
  double start_temp_c = 26.0;
  double warm_up_c = 14.0;              // after the start, with a time constant of five minutes

  /// A sensor without any error.
  static InertialErrors none();
};

/// What the sensor says.  Frames: imu.
struct InertialReading {
  Eigen::Vector3d rate_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_mps2 = Eigen::Vector3d::Zero();
  double temp_c = 0.0;
};

/// Returns what a perfect sensor would say.
InertialReading true_reading(const Motion& motion, const geometry::Se3& T_base_imu, double t_s);

/// Reads the motion of a drive, one sample each 1/rate seconds from 0 to its end.
class InertialSensor {
 public:
  InertialSensor(const Motion& motion, const geometry::Se3& T_base_imu, double rate_hz, const InertialErrors& errors,
                 std::uint64_t seed);

  /// When the next sample is due.
  double next_s() const { return static_cast<double>(index_) / rate_hz_; }

  /// Returns false after the end of the drive.
  bool next(double& t_s, InertialReading& reading);

 private:
  Eigen::Vector3d triple(std::uint64_t stream, double sigma) const;

  const Motion& motion_;
  geometry::Se3 T_base_imu_;
  double rate_hz_;
  InertialErrors errors_;
  Noise noise_;
  std::uint64_t index_ = 0;
  Eigen::Vector3d gyro_bias_;
  Eigen::Vector3d accel_bias_;
  Eigen::Vector3d gyro_scale_;
  Eigen::Vector3d accel_scale_;
  Eigen::Vector3d gyro_per_degree_;
  Eigen::Matrix3d misaligned_;
};

/// Returns all readings of a drive.
std::vector<InertialReading> readings(const Motion& motion, const geometry::Se3& T_base_imu, double rate_hz,
                                      const InertialErrors& errors, std::uint64_t seed);

}  // namespace slamd::simulate
