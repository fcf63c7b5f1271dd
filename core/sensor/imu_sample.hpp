#pragma once

#include <Eigen/Core>

#include "core/base/stamp.hpp"

namespace slamd::sensor {

/// One inertial sample.
/// Frames: both vectors in imu.  Units: rad/s; m/s² of specific force (at rest, level: z = +9.81).
struct ImuSample {
  Stamp stamp{};
  Eigen::Vector3d angular_rate_radps = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();
};

}  // namespace slamd::sensor
