#include "tools/sensors/gravity.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/units.hpp"
#include "core/geometry/so3.hpp"

namespace slamd::sensors {

Gravity compare_gravity(const Eigen::Matrix3d& R_base_imu, const Eigen::Vector3d& up_imu) {
  const Eigen::Vector3d up_base = (R_base_imu * up_imu).normalized();
  const Eigen::Matrix3d R_level_base = geometry::rotation_between(up_base, Eigen::Vector3d::UnitZ());
  Gravity gravity;
  gravity.angle_deg = std::acos(std::clamp(up_base.z(), -1.0, 1.0)) / kDegree;
  gravity.rpy_deg = geometry::rpy_from_rotation(R_level_base * R_base_imu) / kDegree;
  return gravity;
}

std::string up_axis(const Eigen::Vector3d& up_imu) {
  Eigen::Index axis = 0;
  up_imu.cwiseAbs().maxCoeff(&axis);
  return std::string(up_imu[axis] < 0.0 ? "-" : "+") + "xyz"[axis];
}

}  // namespace slamd::sensors
