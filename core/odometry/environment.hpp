#pragma once

#include <array>
#include <cstddef>

#include "core/odometry/odometry_config.hpp"

namespace slamd::odometry {

/// Tells indoor from outdoor by the median range of the last ten scans, with hysteresis.
/// Real-time: no allocation.
class EnvironmentEstimate {
 public:
  EnvironmentEstimate(Environment choice, double indoor_below_m, double outdoor_above_m);

  void add(float median_range_m);

  bool indoor() const { return indoor_; }

 private:
  Environment choice_;
  double indoor_below_m_;
  double outdoor_above_m_;
  bool indoor_;
  std::array<float, 10> ranges_m_{};
  std::size_t count_ = 0;
};

}  // namespace slamd::odometry
