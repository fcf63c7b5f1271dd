#include "drivers/livox/sdk2_frame.hpp"

#include <algorithm>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"
#include "core/base/crc32.hpp"
#include "drivers/livox/checksums.hpp"

namespace slamd::livox {

namespace {

constexpr std::uint8_t kVersion = 0;
constexpr std::size_t kHeaderBytes = 18;  // which the first checksum covers
constexpr std::size_t kPayloadAt = 24;
constexpr std::uint8_t kGpsTimeType = 2;

/// Of nothing it is 0.
std::uint32_t payload_checksum(std::span<const std::byte> payload) { return payload.empty() ? 0 : crc32(payload); }

Payload payload_of(std::span<const std::byte> bytes) {
  Payload payload;
  for (const std::byte byte : bytes) {
    payload.push_back(byte);
  }
  return payload;
}

}  // namespace

FrameResult parse_sdk2_frame(std::span<const std::byte> bytes, Sdk2Frame& frame, std::size_t& size) {
  if (bytes.size() < kPayloadAt) {
    return FrameResult::kTooShort;
  }
  if (load_le<std::uint8_t>(bytes, 0) != kSof) {
    return FrameResult::kNotAFrame;
  }
  if (load_le<std::uint8_t>(bytes, 1) != kVersion) {
    return FrameResult::kUnknownVersion;
  }
  const std::size_t length = load_le<std::uint16_t>(bytes, 2);
  if (length < kPayloadAt || length > bytes.size() || length > kLongestFrame) {
    return FrameResult::kWrongLength;
  }
  if (sdk2_crc16(bytes.first(kHeaderBytes)) != load_le<std::uint16_t>(bytes, kHeaderBytes)) {
    return FrameResult::kBadHeaderChecksum;
  }
  const auto type = load_le<std::uint8_t>(bytes, 10);
  const auto sender = load_le<std::uint8_t>(bytes, 11);
  if (type > 1 || sender > 1) {
    return FrameResult::kUnknownType;
  }
  const std::span<const std::byte> payload = bytes.subspan(kPayloadAt, length - kPayloadAt);
  if (payload_checksum(payload) != load_le<std::uint32_t>(bytes, 20)) {
    return FrameResult::kBadChecksum;
  }
  frame.sequence = load_le<std::uint32_t>(bytes, 4);
  frame.command = static_cast<Sdk2Command>(load_le<std::uint16_t>(bytes, 8));
  frame.ack = type == 1;
  frame.from_device = sender == 1;
  frame.payload = payload;
  size = length;
  return FrameResult::kOk;
}

FrameBytes write_sdk2_frame(const Sdk2Frame& frame) {
  const std::size_t length = kPayloadAt + frame.payload.size();
  SLAMD_ASSERT(length <= FrameBytes::capacity());
  std::array<std::byte, FrameBytes::capacity()> raw{};
  const std::span<std::byte> bytes = std::span(raw).first(length);
  store_le(bytes, 0, kSof);
  store_le(bytes, 1, kVersion);
  store_le(bytes, 2, static_cast<std::uint16_t>(length));
  store_le(bytes, 4, frame.sequence);
  store_le(bytes, 8, static_cast<std::uint16_t>(frame.command));
  store_le(bytes, 10, static_cast<std::uint8_t>(frame.ack ? 1 : 0));
  store_le(bytes, 11, static_cast<std::uint8_t>(frame.from_device ? 1 : 0));
  store_le(bytes, 18, sdk2_crc16(bytes.first(kHeaderBytes)));
  store_le(bytes, 20, payload_checksum(frame.payload));
  std::copy(frame.payload.begin(), frame.payload.end(), bytes.begin() + kPayloadAt);
  return frame_bytes_of(bytes);
}

std::optional<Sdk2Discovery> Sdk2Discovery::parse(std::span<const std::byte> payload) {
  if (payload.size() != 24) {
    return std::nullopt;
  }
  Sdk2Discovery message;
  message.result = load_le<std::uint8_t>(payload, 0);
  message.device_type = load_le<std::uint8_t>(payload, 1);
  for (std::size_t i = 0; i < 16; ++i) {
    message.serial_number.characters[i] = static_cast<char>(payload[2 + i]);
  }
  message.address = load_be<std::uint32_t>(payload, 18);
  message.command_port = load_le<std::uint16_t>(payload, 22);
  return message;
}

Payload Sdk2Discovery::bytes() const {
  std::array<std::byte, 24> raw{};
  store_le<std::uint8_t>(raw, 0, result);
  store_le<std::uint8_t>(raw, 1, device_type);
  for (std::size_t i = 0; i < 16; ++i) {
    raw[2 + i] = static_cast<std::byte>(serial_number.characters[i]);
  }
  store_be<std::uint32_t>(raw, 18, address);
  store_le<std::uint16_t>(raw, 22, command_port);
  return payload_of(raw);
}

std::optional<Sdk2Destination> Sdk2Destination::parse(std::span<const std::byte> value) {
  if (value.size() != 8) {
    return std::nullopt;
  }
  return Sdk2Destination{load_be<std::uint32_t>(value, 0), load_le<std::uint16_t>(value, 4),
                         load_le<std::uint16_t>(value, 6)};
}

Payload Sdk2Destination::bytes() const {
  std::array<std::byte, 8> raw{};
  store_be<std::uint32_t>(raw, 0, host_address);
  store_le<std::uint16_t>(raw, 4, host_port);
  store_le<std::uint16_t>(raw, 6, device_port);
  return payload_of(raw);
}

std::optional<Sdk2GpsTime> Sdk2GpsTime::parse(std::span<const std::byte> payload) {
  if (payload.size() != 9 || load_le<std::uint8_t>(payload, 0) != kGpsTimeType) {
    return std::nullopt;
  }
  return Sdk2GpsTime{load_le<std::uint64_t>(payload, 1)};
}

Payload Sdk2GpsTime::bytes() const {
  std::array<std::byte, 9> raw{};
  store_le<std::uint8_t>(raw, 0, kGpsTimeType);
  store_le<std::uint64_t>(raw, 1, utc_ns);
  return payload_of(raw);
}

std::optional<std::uint8_t> Sdk2Value::as_u8() const {
  return bytes.empty() ? std::nullopt : std::optional(load_le<std::uint8_t>(bytes, 0));
}

std::optional<std::uint32_t> Sdk2Value::as_u32() const {
  return bytes.size() < 4 ? std::nullopt : std::optional(load_le<std::uint32_t>(bytes, 0));
}

Sdk2ValueReader::Sdk2ValueReader(std::span<const std::byte> payload, std::size_t count_at, std::size_t begin) {
  if (payload.size() >= begin) {
    left_ = load_le<std::uint16_t>(payload, count_at);
    bytes_ = payload.subspan(begin);
    good_ = true;
  }
}

bool Sdk2ValueReader::next(Sdk2Value& value) {
  if (left_ == 0 || !good_) {
    return false;
  }
  const std::size_t length = bytes_.size() < 4 ? 0 : load_le<std::uint16_t>(bytes_, 2);
  if (bytes_.size() < 4 + length) {
    good_ = false;
    return false;
  }
  value.key = static_cast<Sdk2Key>(load_le<std::uint16_t>(bytes_, 0));
  value.bytes = bytes_.subspan(4, length);
  bytes_ = bytes_.subspan(4 + length);
  --left_;
  return true;
}

Sdk2ValueWriter::Sdk2ValueWriter() : size_(4) {}

Sdk2ValueWriter::Sdk2ValueWriter(std::uint8_t result) : count_at_(1), size_(3) { store_le<std::uint8_t>(raw_, 0, result); }

void Sdk2ValueWriter::add(Sdk2Key key, std::span<const std::byte> value) {
  SLAMD_ASSERT(size_ + 4 + value.size() <= raw_.size());
  store_le<std::uint16_t>(raw_, size_, static_cast<std::uint16_t>(key));
  store_le<std::uint16_t>(raw_, size_ + 2, static_cast<std::uint16_t>(value.size()));
  std::copy(value.begin(), value.end(), raw_.begin() + static_cast<std::ptrdiff_t>(size_ + 4));
  size_ += 4 + value.size();
  store_le<std::uint16_t>(raw_, count_at_, ++count_);
}

std::uint32_t first_health_code(std::span<const std::byte> codes) {
  std::uint32_t first = 0;
  for (std::size_t at = 0; at + 4 <= codes.size() && first == 0; at += 4) {
    first = load_le<std::uint32_t>(codes, at);
  }
  return first;
}

Payload sdk2_question(std::span<const Sdk2Key> keys) {
  std::array<std::byte, 64> raw{};
  SLAMD_ASSERT(4 + 2 * keys.size() <= raw.size());
  store_le<std::uint16_t>(raw, 0, static_cast<std::uint16_t>(keys.size()));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    store_le<std::uint16_t>(raw, 4 + 2 * i, static_cast<std::uint16_t>(keys[i]));
  }
  return payload_of(std::span(raw).first(4 + 2 * keys.size()));
}

}  // namespace slamd::livox
