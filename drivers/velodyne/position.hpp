#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "core/base/stamp.hpp"

namespace slamd::velodyne {

/// What became of a position packet.
enum class PositionResult : std::uint8_t { kOk, kWrongLength, kBadTimestamp };

enum class PpsState : std::uint8_t { kNone = 0, kSynchronising = 1, kLocked = 2, kError = 3, kUnknown = 255 };

/// One position packet of 512 bytes, sent to port 8308. drivers/gnss reads its sentence.
struct Position {
  DeviceStamp device_stamp{};  // since the top of the hour, as in data packets
  PpsState pps = PpsState::kUnknown;
  FixedVector<char, 128> sentence;  // of the receiver, as it came, without its line end; empty: it hears none

  std::string_view text() const { return {sentence.data(), sentence.size()}; }
};

/// Decodes a position packet. Real-time: no allocation.
PositionResult decode_position(std::span<const std::byte> payload, Position& position);

}  // namespace slamd::velodyne
