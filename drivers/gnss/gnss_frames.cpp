#include "drivers/gnss/gnss_frames.hpp"

#include <algorithm>
#include <string_view>

#include "core/base/bytes.hpp"
#include "drivers/gnss/nmea.hpp"

namespace slamd::gnss {

using transport::FrameVerdict;
using transport::FrameView;

namespace {

constexpr std::byte kUbx1{0xB5};
constexpr std::byte kUbx2{0x62};
constexpr std::byte kRtcm{0xD3};
constexpr std::size_t kRtcmOverhead = 6;

FrameView judged(bool good, std::size_t size) { return {good ? FrameVerdict::kFrame : FrameVerdict::kDamaged, size}; }

FrameView inspect_sentence(std::string_view text) {
  const std::size_t longest = std::min(text.size(), GnssFrames::kLongestSentence);
  for (std::size_t i = 1; i < longest; ++i) {
    if (text[i] == '\n') {
      // The star stands two digits before the end.
      const std::size_t end = text[i - 1] == '\r' ? i - 1 : i;
      return judged(end >= 4 && text[end - 3] == '*' && nmea_checksum_holds(text.substr(0, end)), i + 1);
    }
    if (text[i] == '$') {
      return {FrameVerdict::kDamaged};  // torn, and another begins
    }
    if (text[i] != '\r' && (text[i] < ' ' || text[i] > '~')) {
      return {FrameVerdict::kNoFrame};
    }
  }
  return {longest < GnssFrames::kLongestSentence ? FrameVerdict::kNeedsMore : FrameVerdict::kNoFrame};
}

FrameView inspect_ubx(std::span<const std::byte> bytes) {
  if (bytes.size() > 1 && bytes[1] != kUbx2) {
    return {FrameVerdict::kNoFrame};
  }
  if (bytes.size() < 6) {
    return {FrameVerdict::kNeedsMore};
  }
  const std::size_t payload = load_le<std::uint16_t>(bytes, 4);
  if (payload > ubx::kLongestPayload) {
    return {FrameVerdict::kNoFrame};
  }
  const std::size_t size = ubx::kOverhead + payload;
  return bytes.size() < size ? FrameView{FrameVerdict::kNeedsMore} : judged(ubx_checksum_holds(bytes.first(size)), size);
}

/// CRC-24Q: polynomial 0x864CFB, from zero.
std::uint32_t crc24q(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte) << 16;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc << 1) ^ ((crc & 0x800000U) != 0 ? 0x864CFBU : 0U);
    }
  }
  return crc & 0xFFFFFFU;
}

/// D3 | six bits of zero, length of ten | payload | CRC-24Q: what an RTK receiver is fed, and some echo.
FrameView inspect_rtcm(std::span<const std::byte> bytes) {
  if (bytes.size() > 1 && (bytes[1] & std::byte{0xFC}) != std::byte{0}) {
    return {FrameVerdict::kNoFrame};
  }
  if (bytes.size() < 3) {
    return {FrameVerdict::kNeedsMore};
  }
  const std::size_t size = kRtcmOverhead + load_be<std::uint16_t>(bytes, 1);
  if (bytes.size() < size) {
    return {FrameVerdict::kNeedsMore};
  }
  return judged(crc24q(bytes.first(size - 3)) == (load_be<std::uint32_t>(bytes, size - 4) & 0xFFFFFFU), size);
}

}  // namespace

FrameView GnssFrames::inspect(std::span<const std::byte> bytes) {
  if (bytes[0] == std::byte{'$'}) {
    return inspect_sentence({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  if (bytes[0] == kUbx1) {
    return inspect_ubx(bytes);
  }
  return bytes[0] == kRtcm ? inspect_rtcm(bytes) : FrameView{FrameVerdict::kNoFrame};
}

}  // namespace slamd::gnss
