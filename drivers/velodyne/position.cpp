#include "drivers/velodyne/position.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "core/base/bytes.hpp"

namespace slamd::velodyne {

namespace {

constexpr std::size_t kPacketBytes = 512;
constexpr std::size_t kTimestampAt = 0xC6;
constexpr std::size_t kPpsAt = 0xCA;
constexpr std::size_t kSentenceAt = 0xCE;
constexpr std::size_t kSentenceBytes = 128;
constexpr double kMpsPerKnot = 1852.0 / 3600.0;

std::optional<double> number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;  // from_chars takes "inf" and "nan"
}

std::optional<int> two_digits(std::string_view text, std::size_t at) {
  if (text.size() < at + 2 || text[at] < '0' || text[at] > '9' || text[at + 1] < '0' || text[at + 1] > '9') {
    return std::nullopt;
  }
  return 10 * (text[at] - '0') + (text[at + 1] - '0');
}

/// ddmm.mmm to degrees; nothing beyond the limit.
std::optional<double> angle(std::string_view text, std::string_view hemisphere, double limit_deg) {
  const auto value = number(text);
  if (!value || *value < 0.0 || *value > 100.0 * limit_deg) {
    return std::nullopt;
  }
  const double degrees = static_cast<double>(static_cast<int>(*value / 100.0));
  const double result = degrees + (*value - 100.0 * degrees) / 60.0;
  if (result > limit_deg) {
    return std::nullopt;
  }
  return hemisphere == "S" || hemisphere == "W" ? -result : result;
}

std::optional<std::int64_t> unix_seconds(std::string_view time, std::string_view date) {
  const auto hour = two_digits(time, 0);
  const auto minute = two_digits(time, 2);
  const auto second = two_digits(time, 4);
  const auto day = two_digits(date, 0);
  const auto month = two_digits(date, 2);
  const auto year = two_digits(date, 4);
  if (!hour || !minute || !second || !day || !month || !year || *hour > 23 || *minute > 59 || *second > 60) {
    return std::nullopt;
  }
  // Two digits of a year: 80 to 99 are of the last century.
  const std::chrono::year_month_day ymd{std::chrono::year(*year + (*year < 80 ? 2000 : 1900)),
                                        std::chrono::month(static_cast<unsigned>(*month)),
                                        std::chrono::day(static_cast<unsigned>(*day))};
  if (!ymd.ok()) {
    return std::nullopt;
  }
  const auto days = std::chrono::sys_days(ymd).time_since_epoch().count();
  return ((static_cast<std::int64_t>(days) * 24 + *hour) * 60 + *minute) * 60 + *second;
}

}  // namespace

bool nmea_checksum_holds(std::string_view sentence) {
  const std::size_t star = sentence.rfind('*');
  if (sentence.empty() || sentence.front() != '$' || star == std::string_view::npos || sentence.size() < star + 3) {
    return false;
  }
  unsigned sum = 0;
  for (const char c : sentence.substr(1, star - 1)) {
    sum ^= static_cast<unsigned char>(c);
  }
  unsigned stated = 0;
  const auto [end, error] = std::from_chars(sentence.data() + star + 1, sentence.data() + star + 3, stated, 16);
  return error == std::errc() && end == sentence.data() + star + 3 && stated == sum;
}

std::optional<Rmc> parse_rmc(std::string_view sentence) {
  if (sentence.size() < 6 || (sentence.substr(0, 6) != "$GPRMC" && sentence.substr(0, 6) != "$GNRMC") ||
      !nmea_checksum_holds(sentence)) {
    return std::nullopt;
  }
  std::array<std::string_view, 12> fields;
  std::size_t count = 0;
  std::string_view rest = sentence.substr(0, sentence.rfind('*'));
  while (count < fields.size()) {
    const std::size_t comma = rest.find(',');
    fields[count++] = rest.substr(0, comma);
    if (comma == std::string_view::npos) {
      break;
    }
    rest.remove_prefix(comma + 1);
  }
  const auto seconds = count >= 10 ? unix_seconds(fields[1], fields[9]) : std::nullopt;
  if (!seconds) {
    return std::nullopt;
  }
  const auto latitude_deg = angle(fields[3], fields[4], 90.0);
  const auto longitude_deg = angle(fields[5], fields[6], 180.0);
  Rmc rmc;
  rmc.valid = fields[2] == "A" && latitude_deg && longitude_deg;
  rmc.unix_seconds = *seconds;
  rmc.latitude_deg = latitude_deg.value_or(0.0);
  rmc.longitude_deg = longitude_deg.value_or(0.0);
  rmc.speed_mps = number(fields[7]).value_or(0.0) * kMpsPerKnot;
  rmc.course_deg = number(fields[8]).value_or(0.0);
  return rmc;
}

PositionResult decode_position(std::span<const std::byte> payload, Position& position) {
  if (payload.size() != kPacketBytes) {
    return PositionResult::kWrongLength;
  }
  const auto timestamp_us = load_le<std::uint32_t>(payload, kTimestampAt);
  if (timestamp_us >= 3'600'000'000U) {
    return PositionResult::kBadTimestamp;
  }
  position = Position{};
  position.device_stamp = DeviceStamp{} + std::chrono::microseconds(timestamp_us);
  const auto pps = load_le<std::uint8_t>(payload, kPpsAt);
  position.pps = pps <= 3 ? static_cast<PpsState>(pps) : PpsState::kUnknown;
  std::string_view sentence(reinterpret_cast<const char*>(payload.data()) + kSentenceAt, kSentenceBytes);
  sentence = sentence.substr(0, sentence.find_first_of(std::string_view("\r\n\0", 3)));
  position.has_sentence = !sentence.empty();
  position.sentence_good = nmea_checksum_holds(sentence);
  position.rmc = parse_rmc(sentence);
  return PositionResult::kOk;
}

}  // namespace slamd::velodyne
