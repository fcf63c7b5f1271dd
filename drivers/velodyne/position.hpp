#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/stamp.hpp"

namespace slamd::velodyne {

/// What became of a position packet.
enum class PositionResult : std::uint8_t { kOk, kWrongLength, kBadTimestamp };

enum class PpsState : std::uint8_t { kNone = 0, kSynchronising = 1, kLocked = 2, kError = 3, kUnknown = 255 };

/// What a $GPRMC sentence says. Units: rad-free as on the wire: degrees, knots are converted to m/s.
struct Rmc {
  bool valid = false;  // A, not V, and with a position that can be
  std::int64_t unix_seconds = 0;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double speed_mps = 0.0;
  double course_deg = 0.0;
};

/// One position packet of 512 bytes, sent to port 8308.
struct Position {
  DeviceStamp device_stamp{};  // since the top of the hour, as in data packets
  PpsState pps = PpsState::kUnknown;
  bool has_sentence = false;   // an empty one is a state, not an error
  bool sentence_good = false;  // its checksum holds
  std::optional<Rmc> rmc;
};

/// Decodes a position packet. Real-time: no allocation.
PositionResult decode_position(std::span<const std::byte> payload, Position& position);

/// Reads a $GPRMC or $GNRMC sentence; nothing when it is another, incomplete, or its checksum is wrong.
std::optional<Rmc> parse_rmc(std::string_view sentence);

/// Tells whether "$...*hh" carries the XOR of what stands between $ and *.
bool nmea_checksum_holds(std::string_view sentence);

}  // namespace slamd::velodyne
