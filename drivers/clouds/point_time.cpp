#include "drivers/clouds/point_time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace slamd::clouds {

namespace {

constexpr double kShortestScan_s = 0.005;
constexpr double kLongestScan_s = to_seconds(kLongestScan);
constexpr double kEarliestUnix_s = 1e8;  // 1973: what is later is a date, not an offset
constexpr double kLatestUnix_s = 9e9;    // 2255

constexpr std::string_view kNames[] = {"t",
                                       "time",
                                       "timestamp",
                                       "timestamps",
                                       "offset_time",
                                       "time_offset",
                                       "offset_ns",
                                       "time_ns",
                                       "t_ns",
                                       "point_time",
                                       "stamp",
                                       "relative_time",
                                       "time_stamp",
                                       "offset_time_ns",
                                       "t_us",
                                       "time_us"};

/// The difference of two integers of any size, as a double: exact up to 2^53.
double difference(std::int64_t a, std::int64_t b) {
  return static_cast<double>(
      static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b)));
}

std::optional<TimeUnit> unit_of_name(std::string_view name) {
  if (name.ends_with("_ns")) {
    return TimeUnit::kNanosecond;
  }
  if (name.ends_with("_us")) {
    return TimeUnit::kMicrosecond;
  }
  return name.ends_with("_ms") ? std::optional(TimeUnit::kMillisecond) : std::nullopt;
}

/// Whole seconds and the rest apart, so that a date loses nothing more than its double has lost.
Duration to_duration(double value, TimeUnit unit) {
  const double per_second = 1e9 / static_cast<double>(unit);
  const double whole_s = std::floor(value / per_second);
  const double rest = value - whole_s * per_second;
  return std::chrono::seconds{static_cast<std::int64_t>(whole_s)} +
         Duration{std::llround(rest * static_cast<double>(unit))};
}

/// The smallest finite value of a column over some points, and every value's distance from it in
/// the file's unit.
class TimesFromFirst {
 public:
  TimesFromFirst(const RawCloud& cloud, const Column& column)
      : cloud_(cloud), column_(column), integer_(is_integer(column.type)) {}

  void see(std::size_t point) {
    if (integer_) {
      const std::int64_t value = cloud_.integer(column_, point);
      first_integer_ = seen_ ? std::min(first_integer_, value) : value;
    } else {
      const double value = cloud_.number(column_, point);
      if (!std::isfinite(value)) {
        return;
      }
      first_number_ = seen_ ? std::min(first_number_, value) : value;
    }
    seen_ = true;
  }

  bool seen() const { return seen_; }

  double first() const { return integer_ ? static_cast<double>(first_integer_) : first_number_; }

  std::int64_t first_integer() const { return first_integer_; }

  /// Not finite where the file's value is not.
  double since_first(std::size_t point) const {
    return integer_ ? difference(cloud_.integer(column_, point), first_integer_)
                    : cloud_.number(column_, point) - first_number_;
  }

 private:
  const RawCloud& cloud_;
  const Column& column_;
  bool integer_;
  bool seen_ = false;
  std::int64_t first_integer_ = 0;
  double first_number_ = 0.0;
};

}  // namespace

const Column* time_column(const RawCloud& cloud) {
  for (const std::string_view name : kNames) {
    if (const Column* column = cloud.find(name)) {
      return column;
    }
  }
  return nullptr;
}

std::optional<TimeUnit> detect_unit(const RawCloud& cloud, const Column& column) {
  if (const auto unit = unit_of_name(column.name)) {
    return unit;
  }
  TimesFromFirst times(cloud, column);
  for (std::size_t i = 0; i < cloud.points; ++i) {
    times.see(i);
  }
  double span = 0.0;
  for (std::size_t i = 0; i < cloud.points && times.seen(); ++i) {
    const double value = times.since_first(i);
    span = std::isfinite(value) ? std::max(span, value) : span;
  }
  for (const TimeUnit unit :
       {TimeUnit::kSecond, TimeUnit::kMillisecond, TimeUnit::kMicrosecond, TimeUnit::kNanosecond}) {
    const double span_s = span * static_cast<double>(unit) * 1e-9;
    if (span_s >= kShortestScan_s && span_s < kLongestScan_s) {
      return unit;
    }
  }
  return std::nullopt;
}

std::optional<PointTimes> read_times(const RawCloud& cloud,
                                     const Column& column,
                                     TimeUnit unit,
                                     std::span<const std::uint32_t> points) {
  PointTimes result;
  TimesFromFirst times(cloud, column);
  for (const std::uint32_t point : points) {
    times.see(point);
  }
  const double unit_ns = static_cast<double>(unit);
  result.offset_ns.reserve(points.size());
  for (const std::uint32_t point : points) {
    const double offset_ns = times.since_first(point) * unit_ns;
    if (!(offset_ns >= 0.0 && offset_ns <= to_seconds(kLongestScan) * 1e9)) {
      return std::nullopt;
    }
    result.offset_ns.push_back(static_cast<std::uint32_t>(std::llround(offset_ns)));
    result.span = std::max(result.span, Duration{result.offset_ns.back()});
  }
  const double first_s = times.first() * unit_ns * 1e-9;
  if (!(std::abs(first_s) < kLatestUnix_s)) {
    return std::nullopt;
  }
  result.absolute = first_s > kEarliestUnix_s;
  result.first = is_integer(column.type)
                     ? Duration{times.first_integer() * static_cast<std::int64_t>(unit)}
                     : to_duration(times.first(), unit);
  return result;
}

}  // namespace slamd::clouds
