#pragma once

#include <Eigen/Core>

#include "core/sensor/imu_reading.hpp"
#include "drivers/imu/inertial_result.hpp"
#include "drivers/imu/unit_watch.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// Watches an inertial sensor's samples: how many come, in which units, and where gravity is.
/// Frames: imu.  Threads: one.
class InertialWatch {
 public:
  void add(const sensor::ImuReading& reading);
  void end_second();

  /// Without what the sensor's protocol counts: refused, missing, clipped.
  InertialSeen seen() const;

  /// With what the sensor's protocol has counted.
  InertialSeen seen(const imu::InertialCounters& counters) const;

 private:
  SecondCount samples_;
  imu::UnitWatch units_;
  // Sums of the second in hand.
  double count_ = 0.0;
  Eigen::Vector3d force_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_sum_ = Eigen::Vector3d::Zero();
  double force_square_sum_ = 0.0;
  InertialSeen last_;
};

}  // namespace slamd::sensors
