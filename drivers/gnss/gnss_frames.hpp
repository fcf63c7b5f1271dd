#pragma once

#include <cstddef>
#include <span>

#include "drivers/gnss/ubx.hpp"
#include "drivers/transport/byte_frames.hpp"

namespace slamd::gnss {

/// What a receiver's port carries, all at once: NMEA sentences, UBX, and RTCM 3 that it echoes. For transport::ByteFrames.
struct GnssFrames {
  static constexpr std::size_t kLongest = ubx::kOverhead + ubx::kLongestPayload;
  static constexpr std::size_t kLongestSentence = 130;  // RTK receivers exceed the standard's 82; with CR and LF

  /// Judges the bytes at a place of the stream. A sentence ends with LF, or CR and LF.
  static transport::FrameView inspect(std::span<const std::byte> bytes);

  /// Tells which of the three a good frame is.
  static bool is_sentence(std::span<const std::byte> frame) { return frame[0] == std::byte{'$'}; }
  static bool is_ubx(std::span<const std::byte> frame) { return frame[0] == std::byte{0xB5}; }
};

}  // namespace slamd::gnss
