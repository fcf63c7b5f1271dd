#include "drivers/imu/unit_watch.hpp"

namespace slamd::imu {

namespace {

// Means over a second on a vehicle, whatever it does, lie between 5 and 20 m/s² and below 10 rad/s.
constexpr double kLeast_g = 0.6;
constexpr double kMost_g = 1.6;
constexpr double kFastest_radps = 10.0;

Units judge_means(double force, double rate) {
  if (rate > kFastest_radps) {
    return Units::kInDegrees;
  }
  if (force < kLeast_g) {
    return Units::kNoGravity;
  }
  return force < kMost_g ? Units::kInG : Units::kSi;
}

}  // namespace

const char* in_words(Units units) {
  switch (units) {
    case Units::kInG: return "specific force looks like g, and must be m/s^2";
    case Units::kNoGravity: return "specific force is without gravity, which belongs to it";
    case Units::kInDegrees: return "turn rate looks like deg/s, and must be rad/s";
    default: return "";
  }
}

void UnitWatch::add(const sensor::ImuReading& reading) {
  const Duration since = reading.device_stamp - begin_;
  if (samples_ > 0 && since >= Duration::zero() && since < kPeriod) {
    ++samples_;
    force_sum_ += reading.specific_force_mps2.norm();
    rate_sum_ += reading.angular_rate_radps.norm();
    return;
  }
  if (samples_ >= kFewest && since >= Duration::zero()) {
    units_ = judge_means(force_sum_ / samples_, rate_sum_ / samples_);
  }
  begin_ = reading.device_stamp;
  samples_ = 1;
  force_sum_ = reading.specific_force_mps2.norm();
  rate_sum_ = reading.angular_rate_radps.norm();
}

}  // namespace slamd::imu
