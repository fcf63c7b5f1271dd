#include "drivers/livox/sdk1_frame.hpp"

#include <array>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"
#include "drivers/livox/checksums.hpp"

namespace slamd::livox {

namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kHeaderBytes = 7;  // which the first checksum covers
constexpr std::size_t kPayloadAt = 11;
constexpr std::size_t kAround = 15;  // all but the payload

}  // namespace

FrameResult parse_sdk1_frame(std::span<const std::byte> bytes, Sdk1Frame& frame, std::size_t& size) {
  if (bytes.size() < kAround) {
    return FrameResult::kTooShort;
  }
  if (load_le<std::uint8_t>(bytes, 0) != kSof) {
    return FrameResult::kNotAFrame;
  }
  if (load_le<std::uint8_t>(bytes, 1) != kVersion) {
    return FrameResult::kUnknownVersion;
  }
  const std::size_t length = load_le<std::uint16_t>(bytes, 2);
  if (length < kAround || length > bytes.size() || length > kLongestFrame) {
    return FrameResult::kWrongLength;
  }
  if (sdk1_crc16(bytes.first(kHeaderBytes)) != load_le<std::uint16_t>(bytes, kHeaderBytes)) {
    return FrameResult::kBadHeaderChecksum;
  }
  const auto type = load_le<std::uint8_t>(bytes, 4);
  if (type > static_cast<std::uint8_t>(Sdk1FrameType::kMessage)) {
    return FrameResult::kUnknownType;
  }
  if (sdk1_crc32(bytes.first(length - 4)) != load_le<std::uint32_t>(bytes, length - 4)) {
    return FrameResult::kBadChecksum;
  }
  frame.type = static_cast<Sdk1FrameType>(type);
  frame.sequence = load_le<std::uint16_t>(bytes, 5);
  frame.command = static_cast<Sdk1Command>(load_be<std::uint16_t>(bytes, 9));
  frame.payload = bytes.subspan(kPayloadAt, length - kAround);
  size = length;
  return FrameResult::kOk;
}

FrameBytes write_sdk1_frame(const Sdk1Frame& frame) {
  const std::size_t length = kAround + frame.payload.size();
  SLAMD_ASSERT(length <= FrameBytes::capacity());
  std::array<std::byte, FrameBytes::capacity()> raw{};
  const std::span<std::byte> bytes = std::span(raw).first(length);
  store_le(bytes, 0, kSof);
  store_le(bytes, 1, kVersion);
  store_le(bytes, 2, static_cast<std::uint16_t>(length));
  store_le(bytes, 4, static_cast<std::uint8_t>(frame.type));
  store_le(bytes, 5, frame.sequence);
  store_le(bytes, 7, sdk1_crc16(bytes.first(kHeaderBytes)));
  store_be(bytes, 9, static_cast<std::uint16_t>(frame.command));
  for (std::size_t i = 0; i < frame.payload.size(); ++i) {
    bytes[kPayloadAt + i] = frame.payload[i];
  }
  store_le(bytes, length - 4, sdk1_crc32(bytes.first(length - 4)));
  return frame_bytes_of(bytes);
}

}  // namespace slamd::livox
