#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/base/fixed_vector.hpp"

namespace slamd::livox {

// What the control frames of SDK1 and SDK2 have in common.

/// What became of the bytes at a frame's place; all but the first are refusals.
enum class FrameResult : std::uint8_t {
  kOk,
  kTooShort,           // no room for a frame
  kNotAFrame,          // does not begin with 0xAA
  kUnknownVersion,     // the other SDK's, or a later one's
  kWrongLength,        // announces more than is there, or less than a frame
  kBadHeaderChecksum,
  kUnknownType,
  kBadChecksum,
};

inline constexpr std::size_t kFrameResults = 8;

std::string_view name_of(FrameResult result);

inline constexpr std::size_t kLongestFrame = 1400;

/// What each frame begins with.
inline constexpr std::uint8_t kSof = 0xAA;

/// Tells whether a datagram begins as a control frame does, none of which is shorter than `shortest_bytes`.
inline bool begins_as_control_frame(std::span<const std::byte> payload, std::size_t shortest_bytes) {
  return payload.size() >= shortest_bytes && load_le<std::uint8_t>(payload, 0) == kSof;
}

/// A frame on its way out.
using FrameBytes = FixedVector<std::byte, 256>;

/// Copies bytes that fit.
FrameBytes frame_bytes_of(std::span<const std::byte> bytes);

}  // namespace slamd::livox
