#pragma once

#include <chrono>
#include <cstdint>

namespace slamd {

/// All intervals are integer nanoseconds; doubles named dt_s live inside integrators only.
using Duration = std::chrono::nanoseconds;

/// The clock of slamd's time base: host monotonic time, written out as Unix nanoseconds (design.md, "Frames,
/// time, signs"). It has no now(): time enters the core only as a Stamp inside data, so a replay is deterministic.
struct TimeBase {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<TimeBase>;
  static constexpr bool is_steady = true;
};

/// A point in time on slamd's time base.
using Stamp = TimeBase::time_point;

/// The clock of one sensor, with an origin of its own. Only a ClockModel turns its stamps into Stamp.
struct DeviceTime {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<DeviceTime>;
  static constexpr bool is_steady = false;
};

/// A point in time on a sensor's own clock.
using DeviceStamp = DeviceTime::time_point;

/// Converts an interval to seconds.
constexpr double to_seconds(Duration duration) { return std::chrono::duration<double>(duration).count(); }

/// Converts seconds to an interval, rounded to the nearest nanosecond.
constexpr Duration from_seconds(double seconds) {
  return Duration{static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0.0 ? -0.5 : 0.5))};
}

}  // namespace slamd
