#include "drivers/livox/data_header.hpp"

#include <limits>

#include "core/base/bytes.hpp"

namespace slamd::livox {

namespace {

constexpr std::size_t kTimeOffset = 10;
constexpr std::uint32_t kLongestHour_us = 3'601'000'000;
constexpr std::uint64_t kLongestPps_ns = 2'000'000'000;

std::optional<DeviceStamp> parse_calendar(std::span<const std::byte> payload) {
  const auto byte_at = [payload](std::size_t i) {
    return load_le<std::uint8_t>(payload, kTimeOffset + i);
  };
  const std::chrono::year_month_day date{std::chrono::year{2000 + byte_at(0)},
                                         std::chrono::month{byte_at(1)},
                                         std::chrono::day{byte_at(2)}};
  const std::uint8_t hour = byte_at(3);
  const auto in_hour_us = load_le<std::uint32_t>(payload, kTimeOffset + 4);
  if (!date.ok() || hour > 23 || in_hour_us >= kLongestHour_us) {
    return std::nullopt;
  }
  const Duration since_1970 = std::chrono::sys_days{date}.time_since_epoch() +
                              std::chrono::hours{hour} + std::chrono::microseconds{in_hour_us};
  return DeviceStamp{since_1970};
}

}  // namespace

DataHeader parse_header(std::span<const std::byte> payload) {
  DataHeader header;
  header.version = load_le<std::uint8_t>(payload, 0);
  header.slot = load_le<std::uint8_t>(payload, 1);
  header.lidar_id = load_le<std::uint8_t>(payload, 2);
  header.status_code = load_le<std::uint32_t>(payload, 4);
  header.timestamp_type = load_le<std::uint8_t>(payload, 8);
  header.data_type = load_le<std::uint8_t>(payload, 9);
  return header;
}

std::optional<TimestampType> timestamp_type_of(std::uint8_t raw) {
  switch (raw) {
    case 0:
      return TimestampType::kFreeRunning;
    case 1:
      return TimestampType::kPtp;
    case 3:
      return TimestampType::kGps;
    case 4:
      return TimestampType::kPps;
    default:
      return std::nullopt;
  }
}

std::optional<DeviceStamp> parse_device_stamp(std::span<const std::byte> payload,
                                              TimestampType type) {
  if (type == TimestampType::kGps) {
    return parse_calendar(payload);
  }
  const auto ns = load_le<std::uint64_t>(payload, kTimeOffset);
  const std::uint64_t limit = type == TimestampType::kPps
                                  ? kLongestPps_ns
                                  : std::uint64_t{std::numeric_limits<std::int64_t>::max()};
  if (ns >= limit) {
    return std::nullopt;
  }
  return DeviceStamp{Duration{static_cast<std::int64_t>(ns)}};
}

}  // namespace slamd::livox
