#include "tools/simulate/inertial_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/units.hpp"
#include "core/geometry/so3.hpp"

namespace slamd::simulate {

namespace {


double quantised(double value, double step) { return step > 0.0 ? step * std::round(value / step) : value; }

}  // namespace

InertialReading true_reading(const Motion& motion, const geometry::Se3& T_base_imu, double t_s) {
  constexpr double kStep_s = 1e-4;
  const MotionState state = motion.at(t_s);
  const double before = std::max(0.0, t_s - kStep_s);
  const double after = std::min(motion.duration_s(), t_s + kStep_s);
  const Eigen::Vector3d& w = state.rate_base_radps;
  const Eigen::Vector3d alpha =
      (motion.at(after).rate_base_radps - motion.at(before).rate_base_radps) / (after - before);
  const Eigen::Vector3d lever = T_base_imu.translation();
  const Eigen::Vector3d gravity(0.0, 0.0, -kStandardGravity_mps2);
  const Eigen::Vector3d force_base = state.T_world_base.rotation().transpose() * (state.acceleration_mps2 - gravity) +
                                     alpha.cross(lever) + w.cross(w.cross(lever));
  const Eigen::Matrix3d R_imu_base = T_base_imu.rotation().transpose();
  return {R_imu_base * w, R_imu_base * force_base};
}

InertialErrors InertialErrors::none() {
  InertialErrors errors;
  errors.gyro_noise_radps_sqrthz = errors.accel_noise_mps2_sqrthz = 0.0;
  errors.gyro_bias_radps = errors.accel_bias_mps2 = 0.0;
  errors.gyro_walk_radps2_sqrthz = errors.accel_walk_mps3_sqrthz = 0.0;
  errors.scale = errors.misalignment_rad = 0.0;
  errors.gyro_step_radps = errors.accel_step_mps2 = 0.0;
  errors.gyro_per_degree_radps = 0.0;
  return errors;
}

InertialSensor::InertialSensor(const Motion& motion, const geometry::Se3& T_base_imu, double rate_hz,
                               const InertialErrors& errors, std::uint64_t seed)
    : motion_(motion),
      T_base_imu_(T_base_imu),
      rate_hz_(rate_hz),
      errors_(errors),
      noise_(seed, 60),
      gyro_bias_(triple(10, errors.gyro_bias_radps)),
      accel_bias_(triple(20, errors.accel_bias_mps2)),
      gyro_scale_(Eigen::Vector3d::Ones() + triple(30, errors.scale)),
      accel_scale_(Eigen::Vector3d::Ones() + triple(40, errors.scale)),
      gyro_per_degree_(triple(70, errors.gyro_per_degree_radps)),
      misaligned_(geometry::so3_exp(triple(50, errors.misalignment_rad))) {}

Eigen::Vector3d InertialSensor::triple(std::uint64_t stream, double sigma) const {
  return {sigma * noise_.normal(stream), sigma * noise_.normal(stream + 1), sigma * noise_.normal(stream + 2)};
}

bool InertialSensor::next(double& t_s, InertialReading& reading) {
  t_s = next_s();
  if (t_s > motion_.duration_s()) {
    return false;
  }
  const double root_rate = std::sqrt(rate_hz_);
  const std::uint64_t stream = 1000 + 16 * index_++;
  reading = true_reading(motion_, T_base_imu_, t_s);
  const double warmed_c = errors_.warm_up_c * (1.0 - std::exp(-t_s / 300.0));
  reading.temp_c = errors_.start_temp_c + warmed_c;
  reading.rate_radps = (misaligned_ * reading.rate_radps).cwiseProduct(gyro_scale_) + gyro_bias_ +
                       warmed_c * gyro_per_degree_ + triple(stream, errors_.gyro_noise_radps_sqrthz * root_rate);
  reading.force_mps2 = (misaligned_ * reading.force_mps2).cwiseProduct(accel_scale_) + accel_bias_ +
                       triple(stream + 3, errors_.accel_noise_mps2_sqrthz * root_rate);
  for (int axis = 0; axis < 3; ++axis) {
    reading.rate_radps[axis] = std::clamp(quantised(reading.rate_radps[axis], errors_.gyro_step_radps),
                                          -errors_.gyro_limit_radps, errors_.gyro_limit_radps);
    reading.force_mps2[axis] = std::clamp(quantised(reading.force_mps2[axis], errors_.accel_step_mps2),
                                          -errors_.accel_limit_mps2, errors_.accel_limit_mps2);
  }
  gyro_bias_ += triple(stream + 6, errors_.gyro_walk_radps2_sqrthz / root_rate);
  accel_bias_ += triple(stream + 9, errors_.accel_walk_mps3_sqrthz / root_rate);
  return true;
}

std::vector<InertialReading> readings(const Motion& motion, const geometry::Se3& T_base_imu, double rate_hz,
                                      const InertialErrors& errors, std::uint64_t seed) {
  InertialSensor sensor(motion, T_base_imu, rate_hz, errors, seed);
  std::vector<InertialReading> all;
  double t_s = 0.0;
  for (InertialReading reading; sensor.next(t_s, reading);) {
    all.push_back(reading);
  }
  return all;
}

}  // namespace slamd::simulate
