#include "drivers/recording/csv_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/sensor/stamp_gate.hpp"

namespace slamd::recording {

using sensor::later_by_more;

namespace {

constexpr const char* kImuColumns[] = {"timestamp_ns", "gx_rad_s", "gy_rad_s", "gz_rad_s",
                                       "ax_m_s2",      "ay_m_s2",  "az_m_s2"};
constexpr const char* kWheelColumns[] = {"timestamp_ns", "v_m_s", "w_rad_s"};
constexpr const char* kGnssColumns[] = {"timestamp_ns", "quality", "lat_deg",   "lon_deg",   "alt_m",
                                        "sats",         "hdop",    "speed_m_s", "course_deg"};

/// Rows that are looked at before one is given.
constexpr std::size_t kRowsAhead = 8;

// A file may hold any 64 bits: sums wrap instead of overflowing.
Stamp shifted(Stamp stamp, std::uint64_t back_ns) {
  return Stamp{Duration{static_cast<std::int64_t>(static_cast<std::uint64_t>(stamp.time_since_epoch().count()) - back_ns)}};
}

std::uint64_t nanoseconds(Stamp stamp) { return static_cast<std::uint64_t>(stamp.time_since_epoch().count()); }

/// What a row's number means: it counts as NMEA's GGA does.
sensor::FixQuality quality_of(double number) {
  for (const auto quality : {sensor::FixQuality::kSingle, sensor::FixQuality::kDifferential, sensor::FixQuality::kRtkFixed,
                             sensor::FixQuality::kRtkFloat}) {
    if (number == static_cast<double>(quality)) {
      return quality;
    }
  }
  return sensor::FixQuality::kNone;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) {
    text.remove_prefix(1);
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) {
    text.remove_suffix(1);
  }
  return text;
}

/// Calls field(index, text) for each comma-separated field.
template <typename Field>
std::size_t for_each_field(std::string_view line, Field&& field) {
  std::size_t index = 0;
  for (;;) {
    const std::size_t comma = line.find(',');
    field(index++, trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) {
      return index;
    }
    line.remove_prefix(comma + 1);
  }
}

template <typename T>
bool parse_number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

const char* name_of(RowRefusal reason) {
  switch (reason) {
    case RowRefusal::kTooFewColumns: return "too_few_columns";
    case RowRefusal::kNotANumber: return "not_a_number";
    case RowRefusal::kTimeNotIncreasing: return "time_not_increasing";
    case RowRefusal::kTimeFarAhead: return "time_far_ahead";
  }
  return "?";
}

CsvReader::CsvReader(const std::filesystem::path& file, std::span<const char* const> columns)
    : file_(file), stream_(file), places_(columns.size(), std::string::npos) {
  if (!stream_ || !std::getline(stream_, line_)) {
    throw RecordingError(file, "cannot be read, or is empty");
  }
  ++line_number_;
  for_each_field(line_, [&](std::size_t index, std::string_view name) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (name == columns[i]) {
        places_[i] = index;
      }
    }
  });
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (places_[i] == std::string::npos) {
      throw RecordingError(file, std::string("line 1: the header has no column ") + columns[i]);
    }
  }
}

bool CsvReader::next(Stamp& stamp, std::span<double> values) {
  for (read_ahead(); !ahead_.empty(); read_ahead()) {
    const Row row = std::move(ahead_.front());
    ahead_.pop_front();
    if (const auto refusal = disorder(row)) {
      refuse(*refusal, row.line);
      continue;
    }
    last_ = stamp = shifted(row.stamp, taken_off_ns_);
    std::copy(row.values.begin(), row.values.end(), values.begin());
    ++counters_.rows;
    return true;
  }
  return false;
}

void CsvReader::read_ahead() {
  while (ahead_.size() <= kRowsAhead && std::getline(stream_, line_)) {
    ++line_number_;
    if (trimmed(line_).empty() || line_.front() == '#') {
      continue;
    }
    Row row{{}, std::vector<double>(places_.size() - 1), line_number_};
    if (const auto refusal = parse(row)) {
      refuse(*refusal, row.line);
    } else {
      ahead_.push_back(std::move(row));
    }
  }
}

void CsvReader::refuse(RowRefusal reason, std::uint64_t line) {
  ++counters_.refused[static_cast<std::size_t>(reason)];
  counters_.first_refused_line = counters_.first_refused_line == 0 ? line : std::min(line, counters_.first_refused_line);
}

std::optional<RowRefusal> CsvReader::disorder(const Row& row) {
  if (last_ && shifted(row.stamp, taken_off_ns_) <= *last_) {
    if (!has_stepped_back(row)) {
      return RowRefusal::kTimeNotIncreasing;
    }
    ++counters_.steps_back;
    // One more row's time than from the last one to it.
    taken_off_ns_ = 2 * nanoseconds(row.stamp) - nanoseconds(ahead_.front().stamp) - nanoseconds(*last_);
  }
  return is_far_ahead(row) ? std::optional(RowRefusal::kTimeFarAhead) : std::nullopt;
}

bool CsvReader::is_far_ahead(const Row& row) const {
  return (!last_ || later_by_more(shifted(row.stamp, taken_off_ns_), *last_, kLeap)) &&
         std::any_of(ahead_.begin(), ahead_.end(), [&](const Row& later) {
           return later_by_more(row.stamp, later.stamp, kLeap) && (!last_ || shifted(later.stamp, taken_off_ns_) > *last_);
         });
}

bool CsvReader::has_stepped_back(const Row& row) const {
  const auto is_old = [&](const Row& other) { return later_by_more(*last_, shifted(other.stamp, taken_off_ns_), kLeap); };
  const auto in_order = [](const Row& a, const Row& b) { return a.stamp < b.stamp && !later_by_more(b.stamp, a.stamp, kSlowest); };
  bool steady = ahead_.size() >= kRowsAhead && is_old(row) && in_order(row, ahead_.front());
  for (std::size_t i = 0; steady && i < ahead_.size(); ++i) {
    steady = is_old(ahead_[i]) && (i == 0 || in_order(ahead_[i - 1], ahead_[i]));
  }
  return steady;
}

std::optional<RowRefusal> CsvReader::parse(Row& row) const {
  std::size_t found = 0;
  bool numbers = true;
  for_each_field(line_, [&](std::size_t index, std::string_view text) {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i] != index) {
        continue;
      }
      ++found;
      if (i == 0) {
        std::int64_t ns = 0;
        numbers = parse_number(text, ns) && numbers;
        row.stamp = Stamp{} + Duration(ns);
      } else {
        numbers = parse_number(text, row.values[i - 1]) && std::isfinite(row.values[i - 1]) && numbers;
      }
    }
  });
  if (found < places_.size()) {
    return RowRefusal::kTooFewColumns;
  }
  if (!numbers) {
    return RowRefusal::kNotANumber;
  }
  return std::nullopt;
}

ImuCsvReader::ImuCsvReader(const std::filesystem::path& file) : csv_(file, kImuColumns) {}

bool ImuCsvReader::next(sensor::ImuSample& sample) {
  std::array<double, 6> values{};
  if (!csv_.next(sample.stamp, values)) {
    return false;
  }
  sample.angular_rate_radps = {values[0], values[1], values[2]};
  sample.specific_force_mps2 = {values[3], values[4], values[5]};
  return true;
}

WheelCsvReader::WheelCsvReader(const std::filesystem::path& file) : csv_(file, kWheelColumns) {}

bool WheelCsvReader::next(sensor::WheelSample& sample) {
  std::array<double, 2> values{};
  if (!csv_.next(sample.stamp, values)) {
    return false;
  }
  sample.speed_mps = values[0];
  sample.turn_rate_radps = values[1];
  return true;
}

GnssCsvReader::GnssCsvReader(const std::filesystem::path& file) : csv_(file, kGnssColumns) {}

bool GnssCsvReader::next(sensor::GnssFix& fix) {
  std::array<double, 8> values{};
  fix = {};
  if (!csv_.next(fix.stamp, values)) {
    return false;
  }
  const auto [quality, latitude_deg, longitude_deg, altitude_m, satellites, hdop, speed_mps, course_deg] = values;
  const bool is_place = std::abs(latitude_deg) <= 90.0 && std::abs(longitude_deg) <= 180.0;
  fix.quality = is_place ? quality_of(quality) : sensor::FixQuality::kNone;
  fix.latitude_deg = latitude_deg;
  fix.longitude_deg = longitude_deg;
  fix.altitude_m = altitude_m;
  fix.satellites = static_cast<std::uint8_t>(std::clamp(satellites, 0.0, 255.0));
  fix.hdop = hdop;
  fix.speed_mps = speed_mps;
  fix.course_deg = course_deg;
  return true;
}

}  // namespace slamd::recording
