#include "drivers/gnss/ubx.hpp"

#include <algorithm>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"

namespace slamd::gnss {

namespace {

constexpr std::size_t kTailAt = 78;
constexpr std::int32_t kNanosOfASecond = 1'000'000'000;

struct Sums {
  std::uint8_t a = 0;
  std::uint8_t b = 0;
};

Sums sums_of(std::span<const std::byte> bytes) {
  Sums sums;
  for (const std::byte byte : bytes) {
    sums.a = static_cast<std::uint8_t>(sums.a + std::to_integer<unsigned>(byte));
    sums.b = static_cast<std::uint8_t>(sums.b + sums.a);
  }
  return sums;
}

/// Calls each(offset, field) for all fields of a NavPvt but its tail: one list for both directions.
template <typename Pvt, typename Each>
void each_field(Pvt& pvt, Each&& each) {
  each(0, pvt.tow_ms);
  each(4, pvt.year);
  each(6, pvt.month);
  each(7, pvt.day);
  each(8, pvt.hour);
  each(9, pvt.minute);
  each(10, pvt.second);
  each(11, pvt.valid);
  each(12, pvt.time_accuracy_ns);
  each(16, pvt.nano_ns);
  each(20, pvt.fix_type);
  each(21, pvt.flags);
  each(22, pvt.flags2);
  each(23, pvt.satellites);
  each(24, pvt.longitude_1e7deg);
  each(28, pvt.latitude_1e7deg);
  each(32, pvt.height_mm);
  each(36, pvt.height_msl_mm);
  each(40, pvt.horizontal_accuracy_mm);
  each(44, pvt.vertical_accuracy_mm);
  each(48, pvt.velocity_north_mmps);
  each(52, pvt.velocity_east_mmps);
  each(56, pvt.velocity_down_mmps);
  each(60, pvt.ground_speed_mmps);
  each(64, pvt.heading_of_motion_1e5deg);
  each(68, pvt.speed_accuracy_mmps);
  each(72, pvt.heading_accuracy_1e5deg);
  each(76, pvt.pdop_001);
}

}  // namespace

UbxMessage read_ubx(std::span<const std::byte> frame) {
  SLAMD_ASSERT(frame.size() >= ubx::kOverhead);
  return {load_le<std::uint8_t>(frame, 2), load_le<std::uint8_t>(frame, 3), frame.subspan(6, frame.size() - ubx::kOverhead)};
}

bool ubx_checksum_holds(std::span<const std::byte> frame) {
  if (frame.size() < ubx::kOverhead) {
    return false;
  }
  const Sums sums = sums_of(frame.subspan(2, frame.size() - 4));
  return load_le<std::uint8_t>(frame, frame.size() - 2) == sums.a && load_le<std::uint8_t>(frame, frame.size() - 1) == sums.b;
}

UbxBytes write_ubx(const UbxMessage& message) {
  UbxBytes bytes;
  const auto push = [&](std::size_t value) { bytes.push_back(static_cast<std::byte>(value & 0xFFU)); };
  push(0xB5);
  push(0x62);
  push(message.message_class);
  push(message.id);
  push(message.payload.size());
  push(message.payload.size() >> 8);
  for (const std::byte byte : message.payload) {
    bytes.push_back(byte);
  }
  const Sums sums = sums_of(bytes.view().subspan(2));
  push(sums.a);
  push(sums.b);
  return bytes;
}

std::optional<NavPvt> NavPvt::parse(std::span<const std::byte> payload) {
  if (payload.size() != kBytes && payload.size() != kShortBytes) {
    return std::nullopt;
  }
  NavPvt pvt;
  each_field(pvt, [&](std::size_t at, auto& field) { field = load_le<std::remove_cvref_t<decltype(field)>>(payload, at); });
  pvt.is_short = payload.size() == kShortBytes;
  const auto tail = payload.subspan(kTailAt);
  std::copy(tail.begin(), tail.end(), pvt.tail.begin());
  return pvt;
}

FixedVector<std::byte, NavPvt::kBytes> NavPvt::bytes() const {
  std::array<std::byte, kBytes> raw{};
  each_field(*this, [&](std::size_t at, const auto& field) { store_le(std::span<std::byte>(raw), at, field); });
  std::copy(tail.begin(), tail.end(), raw.begin() + kTailAt);
  FixedVector<std::byte, kBytes> bytes;
  for (const std::byte byte : std::span(raw).first(is_short ? kShortBytes : kBytes)) {
    bytes.push_back(byte);
  }
  return bytes;
}

std::optional<sensor::UtcStamp> NavPvt::utc() const {
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month), std::chrono::day(day)};
  const bool is_one = date.ok() && year >= 1980 && year < 2200 && hour < 24 && minute < 60 && second <= 60 &&
                      nano_ns >= -kNanosOfASecond && nano_ns <= kNanosOfASecond;
  if ((valid & 3U) != 3U || !is_one) {
    return std::nullopt;
  }
  return sensor::UtcStamp(std::chrono::sys_days(date)) + std::chrono::hours(hour) + std::chrono::minutes(minute) +
         std::chrono::seconds(second) + Duration(nano_ns);
}

}  // namespace slamd::gnss
