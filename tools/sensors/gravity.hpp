#pragma once

#include <string>

#include <Eigen/Core>

namespace slamd::sensors {

/// Where gravity is, as an inertial sensor at rest and level shows it.
/// Frames: `up_imu` is the mean specific force in imu: at rest it points up.
struct Gravity {
  double angle_deg = 0.0;      // between what is seen and base's z
  Eigen::Vector3d rpy_deg = Eigen::Vector3d::Zero();  // a rotation of imu in base that would have it there, with the least turn
};

/// Compares what is seen with a configured R_base_imu.
Gravity compare_gravity(const Eigen::Matrix3d& R_base_imu, const Eigen::Vector3d& up_imu);

/// Names the axis that points up most: "+z", "-x".
std::string up_axis(const Eigen::Vector3d& up_imu);

}  // namespace slamd::sensors
