#include "tools/sensors/inertial_watch.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::sensors {

void InertialWatch::add(const sensor::ImuReading& reading) {
  samples_.add();
  units_.add(reading);
  count_ += 1.0;
  force_sum_ += reading.specific_force_mps2;
  rate_sum_ += reading.angular_rate_radps;
  force_square_sum_ += reading.specific_force_mps2.squaredNorm();
}

void InertialWatch::end_second() {
  samples_.end_second();
  if (count_ > 0.0) {
    last_.mean_force_mps2 = force_sum_ / count_;
    last_.mean_rate_radps = rate_sum_ / count_;
    last_.force_spread_mps2 = std::sqrt(std::max(0.0, force_square_sum_ / count_ - last_.mean_force_mps2.squaredNorm()));
  }
  count_ = 0.0;
  force_sum_.setZero();
  rate_sum_.setZero();
  force_square_sum_ = 0.0;
}

InertialSeen InertialWatch::seen() const {
  InertialSeen seen = last_;
  seen.samples = samples_.count();
  seen.units = units_.units();
  return seen;
}

InertialSeen InertialWatch::seen(const imu::InertialCounters& counters) const {
  InertialSeen seen = this->seen();
  for (std::size_t i = static_cast<std::size_t>(imu::InertialResult::kIncomplete); i < imu::kInertialResults; ++i) {
    seen.refused += counters.frames[i];
  }
  seen.missing = counters.missing;
  seen.clipped = counters.clipped;
  return seen;
}

}  // namespace slamd::sensors
