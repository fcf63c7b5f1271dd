#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

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

/// A frame on its way out.
using FrameBytes = FixedVector<std::byte, 256>;

/// Copies bytes that fit.
FrameBytes frame_bytes_of(std::span<const std::byte> bytes);

}  // namespace slamd::livox
