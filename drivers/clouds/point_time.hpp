#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/stamp.hpp"
#include "drivers/clouds/raw_cloud.hpp"

namespace slamd::clouds {

/// The unit of a time field. Units: nanoseconds in one.
enum class TimeUnit : std::int64_t {
  kNanosecond = 1,
  kMicrosecond = 1'000,
  kMillisecond = 1'000'000,
  kSecond = 1'000'000'000,
};

/// The times of one cloud's points.
struct PointTimes {
  Duration first{};                      // the earliest, as in the file
  std::vector<std::uint32_t> offset_ns;  // per point, from the earliest
  Duration span{};                       // from the earliest to the last
  bool absolute = false;                 // the file's values count from 1970, not from the scan
};

/// Returns the column that holds the points' times, by its name: t, time, timestamp, offset_time,
/// time_offset, offset_ns, ... or nullptr.
const Column* time_column(const RawCloud& cloud);

/// Says in which unit a time column counts: what its name says (_ns, _us, _ms at the end), else the
/// one in which the scan lasts 5 ms to 1 s. These ranges do not overlap, so at most one fits;
/// nothing when none does (all times equal).
std::optional<TimeUnit> detect_unit(const RawCloud& cloud, const Column& column);

/// Reads the times of the points listed in `points` (indices), in the given unit.
/// Integers keep every nanosecond, whatever their size. Returns nothing when they span more than
/// kLongestScan.
std::optional<PointTimes> read_times(const RawCloud& cloud,
                                     const Column& column,
                                     TimeUnit unit,
                                     std::span<const std::uint32_t> points);

inline constexpr Duration kLongestScan = std::chrono::seconds{1};

}  // namespace slamd::clouds
