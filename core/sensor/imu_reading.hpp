#pragma once

#include <Eigen/Core>

#include "core/base/stamp.hpp"

namespace slamd::sensor {

/// One inertial sample as it came in, still on the sensor's clock: a ClockModel makes an ImuSample of it.
/// Frames: both vectors in imu.  Units: rad/s; m/s² of specific force (at rest, level: z = +9.81).
struct ImuReading {
  DeviceStamp device_stamp{};
  Stamp received{};
  Eigen::Vector3d angular_rate_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();
};

}  // namespace slamd::sensor
