#include "drivers/clouds/conversion.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string_view>

namespace slamd::clouds {

namespace {

// A first point farther from zero than this has not the offset in its scan but the time on some
// clock.
constexpr Duration kLargestOffset = kLongestScan;
constexpr double kFarthest_m = 1e5;  // beyond this a float is no coordinate of a lidar's point

const Column* first_of(const RawCloud& raw, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (const Column* column = raw.find(name)) {
      return column;
    }
  }
  return nullptr;
}

void to_lower(RawCloud& raw) {
  for (Column& column : raw.columns) {
    for (char& c : column.name) {
      c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
}

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(value > 0.0 ? std::min(value, 255.0) : 0.0);  // NaN gives 0
}

/// What takes a column's numbers to 0..255.
double intensity_scale(const RawCloud& raw, const Column* column) {
  if (column == nullptr || is_integer(column->type)) {
    return 1.0;
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < raw.points; ++i) {
    const double value = raw.number(*column, i);
    largest = value > largest ? value : largest;
  }
  return largest <= 1.0 ? 255.0 : 1.0;
}

/// The columns that make points.
struct PointColumns {
  const Column* x;
  const Column* y;
  const Column* z;
  const Column* intensity;
  const Column* line;
  const Column* tag;
  const Column* echo;

  explicit PointColumns(const RawCloud& raw)
      : x(raw.find("x")),
        y(raw.find("y")),
        z(raw.find("z")),
        intensity(first_of(raw, {"intensity", "i", "reflectivity", "reflectance"})),
        line(first_of(raw, {"ring", "line", "channel", "laser_id", "laser"})),
        tag(raw.find("tag")),
        echo(first_of(raw, {"echo", "return", "return_number"})) {}
};

std::uint8_t byte_of(const RawCloud& raw, const Column* column, std::size_t point, double scale) {
  return column == nullptr ? std::uint8_t{0} : to_byte(raw.number(*column, point) * scale);
}

/// A return has finite coordinates, not all zero.
bool is_return(double x_m, double y_m, double z_m) {
  const double sum_m = std::abs(x_m) + std::abs(y_m) + std::abs(z_m);
  return sum_m > 0.0 && sum_m < kFarthest_m;
}

}  // namespace

ScanPlace place_in_time(const Cloud& cloud,
                        std::optional<Stamp> stamp,
                        Stamp fallback,
                        Duration period) {
  ScanPlace place;
  if (!cloud.has_time) {
    place.end = stamp.value_or(fallback);
    place.begin = place.end - period;
    return place;
  }
  const bool own_clock = cloud.first_time > kLargestOffset || cloud.first_time < -kLargestOffset;
  place.by_points = own_clock && (cloud.absolute_time || !stamp);
  const Stamp zero = stamp.value_or(fallback - period);
  place.begin = place.by_points ? Stamp{} + cloud.first_time
                                : zero + (own_clock ? Duration{} : cloud.first_time);
  place.end = place.begin + cloud.span + Duration{1};
  return place;
}

std::optional<CloudRefusal> CloudConverter::convert(RawCloud& raw, Cloud& cloud) {
  to_lower(raw);
  const PointColumns columns(raw);
  cloud = Cloud{};
  kept_.clear();
  if (columns.x == nullptr || columns.y == nullptr || columns.z == nullptr ||
      raw.points > std::numeric_limits<std::uint32_t>::max()) {
    return CloudRefusal::kNoCoordinates;
  }
  const double scale = intensity_scale(raw, columns.intensity);
  const bool by_rows = columns.line == nullptr && raw.height > 1 &&
                       raw.height <= kMaxGuessedLines && raw.points % raw.height == 0;
  const std::size_t width = by_rows ? std::max<std::size_t>(raw.points / raw.height, 1) : 1;
  for (std::size_t i = 0; i < raw.points; ++i) {
    const double x_m = raw.number(*columns.x, i);
    const double y_m = raw.number(*columns.y, i);
    const double z_m = raw.number(*columns.z, i);
    if (!is_return(x_m, y_m, z_m)) {
      ++cloud.empty;
      continue;
    }
    sensor::Point point;
    point.x_m = static_cast<float>(x_m);
    point.y_m = static_cast<float>(y_m);
    point.z_m = static_cast<float>(z_m);
    point.intensity = byte_of(raw, columns.intensity, i, scale);
    point.line =
        by_rows ? static_cast<std::uint8_t>(i / width) : byte_of(raw, columns.line, i, 1.0);
    point.tag = byte_of(raw, columns.tag, i, 1.0);
    point.echo = byte_of(raw, columns.echo, i, 1.0);
    cloud.points.push_back(point);
    kept_.push_back(static_cast<std::uint32_t>(i));
  }
  if (const auto refusal = set_times(raw, cloud)) {
    return refusal;
  }
  if (columns.line != nullptr) {
    cloud.lines = LineSource::kField;
  } else if (by_rows) {
    cloud.lines = LineSource::kRows;
  } else if (set_lines_by_firing_order(cloud.points)) {
    cloud.lines = LineSource::kFiringOrder;
  } else {
    set_lines_by_elevation(cloud.points);
    cloud.lines = LineSource::kElevation;
  }
  return std::nullopt;
}

std::optional<CloudRefusal> CloudConverter::set_times(const RawCloud& raw, Cloud& cloud) {
  const Column* column = use_time_ ? time_column(raw) : nullptr;
  if (column == nullptr || cloud.points.empty()) {
    return std::nullopt;
  }
  if (!unit_) {
    unit_ = detect_unit(raw, *column);
  }
  if (!unit_) {
    return std::nullopt;
  }
  const auto times = read_times(raw, *column, *unit_, kept_);
  if (!times) {
    return CloudRefusal::kBadTime;
  }
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    cloud.points[i].offset_ns = times->offset_ns[i];
  }
  cloud.has_time = true;
  cloud.first_time = times->first;
  cloud.span = times->span;
  cloud.absolute_time = times->absolute;
  return std::nullopt;
}

}  // namespace slamd::clouds
