#pragma once

#include "core/base/stamp.hpp"

namespace slamd::sensor {

/// One sample of the wheel odometry: how fast base moves ahead, and turns, as the wheels have it.
/// Frames: base.  Units: m/s, rad/s.
struct WheelSample {
  Stamp stamp{};
  double speed_mps = 0.0;
  double turn_rate_radps = 0.0;
};

}  // namespace slamd::sensor
