#include "daemon/devices/utc_feed.hpp"

namespace slamd::devices {

namespace {

/// NAV-PVT says the second as it has measured it.
constexpr Duration kWhole = std::chrono::milliseconds(5);

}  // namespace

std::optional<livox::Sdk1Utc> UtcFeed::due(const sensor::GnssFix& fix, Stamp now) {
  if (!fix.is_good() || !fix.utc || now - fix.stamp > kNewest || now < fix.stamp) {
    return std::nullopt;
  }
  const auto second = std::chrono::round<std::chrono::seconds>(*fix.utc);
  if (std::chrono::abs(*fix.utc - second) > kWhole || told_ == second) {
    return std::nullopt;
  }
  const auto day = std::chrono::floor<std::chrono::days>(second);
  const auto hour = std::chrono::floor<std::chrono::hours>(second);
  const std::chrono::year_month_day date{day};
  const int year = static_cast<int>(date.year());
  if (year < 2000 || year > 2255) {
    return std::nullopt;  // a byte counts from 2000
  }
  told_ = second;
  livox::Sdk1Utc utc;
  utc.year = static_cast<std::uint16_t>(year);
  utc.month = static_cast<std::uint8_t>(static_cast<unsigned>(date.month()));
  utc.day = static_cast<std::uint8_t>(static_cast<unsigned>(date.day()));
  utc.hour = static_cast<std::uint8_t>((hour - day) / std::chrono::hours(1));
  utc.in_hour_us = static_cast<std::uint32_t>(std::chrono::microseconds(second - hour).count());
  return utc;
}

}  // namespace slamd::devices
