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
};

/// What the sensor says.  Frames: imu.
struct InertialReading {
  Eigen::Vector3d rate_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_mps2 = Eigen::Vector3d::Zero();
};

/// Returns what a perfect sensor would say.
InertialReading true_reading(const Motion& motion, const geometry::Se3& T_base_imu, double t_s);

/// Makes the readings of a drive, one each 1/rate seconds from 0 to its end.
std::vector<InertialReading> readings(const Motion& motion, const geometry::Se3& T_base_imu, double rate_hz,
                                      const InertialErrors& errors, std::uint64_t seed);

}  // namespace slamd::simulate
