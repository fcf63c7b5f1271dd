#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/fixed_vector.hpp"
#include "core/sensor/gnss_fix.hpp"

namespace slamd::gnss {

/// The frame of u-blox receivers: B5 62 | class | id | length u16 | payload | two sums.
namespace ubx {
inline constexpr std::size_t kOverhead = 8;
inline constexpr std::size_t kLongestPayload = 2048;  // more is no length, but noise
inline constexpr std::uint8_t kNav = 0x01;
inline constexpr std::uint8_t kNavPvt = 0x07;
}  // namespace ubx

/// A good frame, without its sums.
struct UbxMessage {
  std::uint8_t message_class = 0;
  std::uint8_t id = 0;
  std::span<const std::byte> payload;
};

/// Reads a whole frame whose sums hold.
UbxMessage read_ubx(std::span<const std::byte> frame);

/// Tells whether the sums of a whole frame hold (8-bit Fletcher over class to payload).
bool ubx_checksum_holds(std::span<const std::byte> frame);

using UbxBytes = FixedVector<std::byte, 256>;

/// Writes a frame; its payload has at most 248 bytes.
UbxBytes write_ubx(const UbxMessage& message);

enum class UbxFixType : std::uint8_t { kNone, kDeadReckoning, k2d, k3d, kWithDeadReckoning, kTimeOnly };

/// UBX-NAV-PVT as it is on the wire; units are the wire's.
/// Source: gnss.md §2.
struct NavPvt {
  static constexpr std::size_t kBytes = 92;
  static constexpr std::size_t kShortBytes = 84;  // u-blox 7

  std::uint32_t tow_ms = 0;
  std::uint16_t year = 0;
  std::uint8_t month = 0;
  std::uint8_t day = 0;
  std::uint8_t hour = 0;
  std::uint8_t minute = 0;
  std::uint8_t second = 0;  // 60 in a leap second
  std::uint8_t valid = 0;   // b0 date, b1 time, b2 fully resolved
  std::uint32_t time_accuracy_ns = 0;
  std::int32_t nano_ns = 0;  // to be added; may be negative
  std::uint8_t fix_type = 0;
  std::uint8_t flags = 0;  // b0 the fix holds, b1 differential, b6-7 carrier: 1 float, 2 fixed
  std::uint8_t flags2 = 0;
  std::uint8_t satellites = 0;
  std::int32_t longitude_1e7deg = 0;
  std::int32_t latitude_1e7deg = 0;
  std::int32_t height_mm = 0;  // above the ellipsoid
  std::int32_t height_msl_mm = 0;
  std::uint32_t horizontal_accuracy_mm = 0;
  std::uint32_t vertical_accuracy_mm = 0;
  std::int32_t velocity_north_mmps = 0;
  std::int32_t velocity_east_mmps = 0;
  std::int32_t velocity_down_mmps = 0;
  std::int32_t ground_speed_mmps = 0;
  std::int32_t heading_of_motion_1e5deg = 0;
  std::uint32_t speed_accuracy_mmps = 0;
  std::uint32_t heading_accuracy_1e5deg = 0;
  std::uint16_t pdop_001 = 0;
  std::array<std::byte, 14> tail{};  // bytes 78 to 91, which differ by generation; b0 of the first: position invalid
  bool is_short = false;             // without the last eight

  /// Reads a payload; nothing for another length.
  static std::optional<NavPvt> parse(std::span<const std::byte> payload);

  /// The payload of the same bytes.
  FixedVector<std::byte, kBytes> bytes() const;

  /// Calendar time; nothing until the receiver knows date and time, or for one that is none.
  std::optional<sensor::UtcStamp> utc() const;
};

}  // namespace slamd::gnss
