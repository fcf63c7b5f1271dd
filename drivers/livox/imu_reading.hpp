#pragma once

#include <Eigen/Core>

#include "core/base/stamp.hpp"

namespace slamd::livox {

/// One sample of the built-in IMU, still on the sensor's clock.
/// Frames: both vectors in imu, whose axes are parallel to lidar's.  Units: rad/s; m/s² of specific
/// force.
struct ImuReading {
  DeviceStamp device_stamp{};
  Stamp received{};
  Eigen::Vector3d angular_rate_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();
};

}  // namespace slamd::livox
