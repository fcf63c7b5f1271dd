#include "tools/simulate/inertial_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::simulate {

namespace {

constexpr double kGravity_mps2 = 9.80665;

double quantised(double value, double step) { return step > 0.0 ? step * std::round(value / step) : value; }

}  // namespace

InertialReading true_reading(const Motion& motion, const geometry::Se3& T_base_imu, double t_s) {
  constexpr double kStep_s = 1e-4;
  const MotionState state = motion.at(t_s);
  const double before = std::max(0.0, t_s - kStep_s);
  const double after = std::min(motion.duration_s(), t_s + kStep_s);
  const Eigen::Vector3d& w = state.rate_base_radps;
  const Eigen::Vector3d alpha = (motion.at(after).rate_base_radps - motion.at(before).rate_base_radps) / (after - before);
  const Eigen::Vector3d lever = T_base_imu.translation();
  const Eigen::Vector3d gravity(0.0, 0.0, -kGravity_mps2);
  const Eigen::Vector3d force_base = state.T_world_base.rotation().transpose() * (state.acceleration_mps2 - gravity) +
                                     alpha.cross(lever) + w.cross(w.cross(lever));
  const Eigen::Matrix3d R_imu_base = T_base_imu.rotation().transpose();
  return {R_imu_base * w, R_imu_base * force_base};
}

std::vector<InertialReading> readings(const Motion& motion, const geometry::Se3& T_base_imu, double rate_hz,
                                      const InertialErrors& errors, std::uint64_t seed) {
  const Noise noise(seed, 60);
  const auto triple = [&](std::uint64_t stream, double sigma) {
    return Eigen::Vector3d(sigma * noise.normal(stream), sigma * noise.normal(stream + 1), sigma * noise.normal(stream + 2));
  };
  Eigen::Vector3d gyro_bias = triple(10, errors.gyro_bias_radps);
  Eigen::Vector3d accel_bias = triple(20, errors.accel_bias_mps2);
  const Eigen::Vector3d gyro_scale = Eigen::Vector3d::Ones() + triple(30, errors.scale);
  const Eigen::Vector3d accel_scale = Eigen::Vector3d::Ones() + triple(40, errors.scale);
  const Eigen::Matrix3d misaligned = geometry::so3_exp(triple(50, errors.misalignment_rad));
  const double root_rate = std::sqrt(rate_hz);
  const auto count = static_cast<std::uint64_t>(motion.duration_s() * rate_hz) + 1;
  std::vector<InertialReading> result;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t stream = 1000 + 16 * i;
    InertialReading reading = true_reading(motion, T_base_imu, static_cast<double>(i) / rate_hz);
    reading.rate_radps = (misaligned * reading.rate_radps).cwiseProduct(gyro_scale) + gyro_bias +
                         triple(stream, errors.gyro_noise_radps_sqrthz * root_rate);
    reading.force_mps2 = (misaligned * reading.force_mps2).cwiseProduct(accel_scale) + accel_bias +
                         triple(stream + 3, errors.accel_noise_mps2_sqrthz * root_rate);
    for (int axis = 0; axis < 3; ++axis) {
      reading.rate_radps[axis] = quantised(reading.rate_radps[axis], errors.gyro_step_radps);
      reading.force_mps2[axis] = quantised(reading.force_mps2[axis], errors.accel_step_mps2);
    }
    result.push_back(reading);
    gyro_bias += triple(stream + 6, errors.gyro_walk_radps2_sqrthz / root_rate);
    accel_bias += triple(stream + 9, errors.accel_walk_mps3_sqrthz / root_rate);
  }
  return result;
}

}  // namespace slamd::simulate
