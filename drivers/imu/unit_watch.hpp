#pragma once

#include <cstdint>

#include "core/sensor/imu_reading.hpp"

namespace slamd::imu {

/// What the numbers of an inertial sensor look like.
enum class Units : std::uint8_t {
  kUnknown,    // not yet a second of samples
  kSi,
  kInG,        // specific force of about 1, where it should be 9.8
  kNoGravity,  // gravity was taken out of it
  kInDegrees,  // turn rates that no vehicle has, were they rad/s
};

/// Says in words what is wrong; empty: nothing.
const char* in_words(Units units);

/// Watches whether samples are in the units that they should be in: by their means over a second of device time.
/// Real-time: never allocates; O(1); one thread.
class UnitWatch {
 public:
  static constexpr Duration kPeriod = std::chrono::seconds{1};
  static constexpr int kFewest = 10;  // samples of which a mean is taken

  void add(const sensor::ImuReading& reading);

  /// Of the last whole second.
  Units units() const { return units_; }

 private:
  DeviceStamp begin_{};
  int samples_ = 0;
  double force_sum_ = 0.0;
  double rate_sum_ = 0.0;
  Units units_ = Units::kUnknown;
};

}  // namespace slamd::imu
