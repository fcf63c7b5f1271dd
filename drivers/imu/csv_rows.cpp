#include "drivers/imu/csv_rows.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "drivers/imu/inertial_result.hpp"

namespace slamd::imu {

namespace {

constexpr std::size_t kColumns = 7;
constexpr std::int64_t kMaxStamp_ns = std::int64_t{1} << 62;  // half the range: differences of stamps do not overflow

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlank);
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

template <typename T>
bool parse_number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

RowResult parse(std::string_view row, sensor::ImuReading& reading) {
  const auto commas = static_cast<std::size_t>(std::count(row.begin(), row.end(), ','));
  if (commas + 1 != kColumns && commas != kColumns) {
    return RowResult::kWrongColumns;
  }
  const auto next_field = [&row] {
    const std::size_t comma = row.find(',');
    const std::string_view field = trimmed(row.substr(0, comma));
    row.remove_prefix(comma == std::string_view::npos ? row.size() : comma + 1);
    return field;
  };
  std::int64_t stamp_ns = 0;
  if (!parse_number(next_field(), stamp_ns)) {
    return RowResult::kNotANumber;
  }
  std::array<double, kColumns - 1> values{};
  for (double& value : values) {
    if (!parse_number(next_field(), value) || !std::isfinite(value)) {
      return RowResult::kNotANumber;
    }
  }
  if (stamp_ns < 0 || stamp_ns > kMaxStamp_ns) {
    return RowResult::kStampOutOfRange;
  }
  reading.device_stamp = DeviceStamp{} + Duration(stamp_ns);
  reading.angular_rate_radps = {values[0], values[1], values[2]};
  reading.specific_force_mps2 = {values[3], values[4], values[5]};
  return judge(reading) == InertialResult::kSample ? RowResult::kOk : RowResult::kOutOfRange;
}

}  // namespace

const char* name_of(RowResult result) {
  switch (result) {
    case RowResult::kOk: return "ok";
    case RowResult::kWrongColumns: return "wrong_columns";
    case RowResult::kNotANumber: return "not_a_number";
    case RowResult::kStampOutOfRange: return "stamp_out_of_range";
    case RowResult::kOutOfRange: return "out_of_range";
    case RowResult::kTooLong: return "too_long";
    case RowResult::kFragment: return "fragment";
  }
  return "?";
}

RowCounters CsvRows::counters() const {
  RowCounters counters;
  std::transform(counters_.begin(), counters_.end(), counters.rows.begin(), [](const Counter& c) { return c.value(); });
  return counters;
}

bool CsvRows::decode(std::string_view row, sensor::ImuReading& reading) {
  row = trimmed(row);
  if (row.empty()) {
    return false;
  }
  const RowResult result = row.size() > kMaxRowBytes ? RowResult::kTooLong : parse(row, reading);
  count(result);
  return result == RowResult::kOk;
}

void CsvRows::keep(std::string_view piece) {
  if (piece.size() > row_.size() - row_bytes_) {
    too_long_ = true;
    return;
  }
  std::copy(piece.begin(), piece.end(), row_.begin() + static_cast<std::ptrdiff_t>(row_bytes_));
  row_bytes_ += piece.size();
}

std::string_view CsvRows::finish_row() {
  const std::string_view row(row_.data(), row_bytes_);
  const bool was_too_long = too_long_;
  const bool was_synchronised = synchronised_;
  row_bytes_ = 0;
  too_long_ = false;
  synchronised_ = true;
  if (!was_synchronised) {
    if (was_too_long || !row.empty()) {
      count(RowResult::kFragment);
    }
    return {};
  }
  if (was_too_long) {
    count(RowResult::kTooLong);
    return {};
  }
  return row;
}

void CsvRows::restart_stream() {
  if (row_bytes_ > 0 || too_long_) {
    count(RowResult::kFragment);
  }
  row_bytes_ = 0;
  too_long_ = false;
  synchronised_ = false;
}

}  // namespace slamd::imu
