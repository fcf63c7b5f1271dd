#pragma once

#include <cstdint>

#include "tools/simulate/motion.hpp"
#include "tools/simulate/noise.hpp"

namespace slamd::simulate {

/// How wheels err.
struct WheelErrors {
  double track_m = 0.6;
  double ticks_per_m = 2000.0;
  double scale = 0.01;          // of each side's circumference, 1σ
  double noise = 0.01;          // of each side's speed, 1σ
  double slip_in_turns = 0.15;  // more that the sides turn than the body does
  double slip_chance = 0.02;    // per second: both sides spin for a moment
};

/// What the wheels say: columns of odom.csv.
struct WheelReading {
  double left_mps = 0.0;
  double right_mps = 0.0;
  std::int64_t left_ticks = 0;
  std::int64_t right_ticks = 0;
  double v_mps = 0.0;
  double w_radps = 0.0;
};

/// Counts the turns of a drive's wheels.
class WheelSensor {
 public:
  WheelSensor(const Motion& motion, double rate_hz, const WheelErrors& errors, std::uint64_t seed);

  /// Returns false after the end of the drive.
  bool next(double& t_s, WheelReading& reading);

 private:
  const Motion& motion_;
  double rate_hz_;
  WheelErrors errors_;
  Noise noise_;
  std::uint64_t index_ = 0;
  double left_m_ = 0.0;
  double right_m_ = 0.0;
};

}  // namespace slamd::simulate
