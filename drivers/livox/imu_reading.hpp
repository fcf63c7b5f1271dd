#pragma once

#include "core/sensor/imu_reading.hpp"

namespace slamd::livox {

/// One sample of the built-in IMU, whose axes are parallel to lidar's.
using ImuReading = sensor::ImuReading;

}  // namespace slamd::livox
