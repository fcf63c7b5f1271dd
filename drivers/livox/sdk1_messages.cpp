#include "drivers/livox/sdk1_messages.hpp"

#include <algorithm>

#include "core/base/bytes.hpp"

namespace slamd::livox {

namespace {

Payload payload_of(std::span<const std::byte> bytes) {
  Payload payload;
  for (const std::byte byte : bytes) {
    payload.push_back(byte);
  }
  return payload;
}

}  // namespace

std::string_view DeviceCode::view() const {
  const auto end = std::find(characters.begin(), characters.end(), '\0');
  return {characters.data(), static_cast<std::size_t>(end - characters.begin())};
}

DeviceCode DeviceCode::of(std::string_view text) {
  DeviceCode code;
  std::copy_n(text.data(), std::min(text.size(), code.characters.size()), code.characters.begin());
  return code;
}

std::optional<Sdk1Broadcast> Sdk1Broadcast::parse(std::span<const std::byte> payload) {
  if (payload.size() != 19) {
    return std::nullopt;
  }
  Sdk1Broadcast message;
  for (std::size_t i = 0; i < message.code.characters.size(); ++i) {
    message.code.characters[i] = static_cast<char>(payload[i]);
  }
  message.device_type = load_le<std::uint8_t>(payload, 16);
  message.reserved = load_le<std::uint16_t>(payload, 17);
  return message;
}

Payload Sdk1Broadcast::bytes() const {
  std::array<std::byte, 19> raw{};
  for (std::size_t i = 0; i < code.characters.size(); ++i) {
    raw[i] = static_cast<std::byte>(code.characters[i]);
  }
  store_le<std::uint8_t>(raw, 16, device_type);
  store_le<std::uint16_t>(raw, 17, reserved);
  return payload_of(raw);
}

std::optional<Sdk1Handshake> Sdk1Handshake::parse(std::span<const std::byte> payload) {
  if (payload.size() != 8 && payload.size() != 10) {
    return std::nullopt;
  }
  Sdk1Handshake message;
  message.host_address = load_be<std::uint32_t>(payload, 0);
  message.data_port = load_le<std::uint16_t>(payload, 4);
  message.command_port = load_le<std::uint16_t>(payload, 6);
  if (payload.size() == 10) {
    message.imu_port = load_le<std::uint16_t>(payload, 8);
  }
  return message;
}

Payload Sdk1Handshake::bytes() const {
  std::array<std::byte, 10> raw{};
  store_be<std::uint32_t>(raw, 0, host_address);
  store_le<std::uint16_t>(raw, 4, data_port);
  store_le<std::uint16_t>(raw, 6, command_port);
  store_le<std::uint16_t>(raw, 8, imu_port.value_or(0));
  return payload_of(std::span(raw).first(imu_port ? 10 : 8));
}

std::optional<Sdk1HeartbeatAck> Sdk1HeartbeatAck::parse(std::span<const std::byte> payload) {
  if (payload.size() != 7) {
    return std::nullopt;
  }
  Sdk1HeartbeatAck message;
  message.result = load_le<std::uint8_t>(payload, 0);
  constexpr auto kLast = static_cast<std::uint8_t>(Sdk1WorkState::kUnknown);
  message.state = static_cast<Sdk1WorkState>(std::min(load_le<std::uint8_t>(payload, 1), kLast));
  message.features = load_le<std::uint8_t>(payload, 2);
  message.status_or_progress = load_le<std::uint32_t>(payload, 3);
  return message;
}

Payload Sdk1HeartbeatAck::bytes() const {
  std::array<std::byte, 7> raw{};
  store_le<std::uint8_t>(raw, 0, result);
  store_le<std::uint8_t>(raw, 1, static_cast<std::uint8_t>(state));
  store_le<std::uint8_t>(raw, 2, features);
  store_le<std::uint32_t>(raw, 3, status_or_progress);
  return payload_of(raw);
}

std::optional<Sdk1DeviceInfo> Sdk1DeviceInfo::parse(std::span<const std::byte> payload) {
  if (payload.size() != 5) {
    return std::nullopt;
  }
  Sdk1DeviceInfo message;
  message.result = load_le<std::uint8_t>(payload, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    message.firmware[i] = load_le<std::uint8_t>(payload, 1 + i);
  }
  return message;
}

Payload Sdk1DeviceInfo::bytes() const {
  std::array<std::byte, 5> raw{};
  store_le<std::uint8_t>(raw, 0, result);
  for (std::size_t i = 0; i < 4; ++i) {
    store_le<std::uint8_t>(raw, 1 + i, firmware[i]);
  }
  return payload_of(raw);
}

std::optional<Sdk1Extrinsic> Sdk1Extrinsic::parse(std::span<const std::byte> payload) {
  if (payload.size() != 24) {
    return std::nullopt;
  }
  Sdk1Extrinsic message;
  for (std::size_t i = 0; i < 3; ++i) {
    message.rpy_deg[i] = load_le<float>(payload, 4 * i);
    message.xyz_mm[i] = load_le<std::int32_t>(payload, 12 + 4 * i);
  }
  return message;
}

Payload Sdk1Extrinsic::bytes() const {
  std::array<std::byte, 24> raw{};
  for (std::size_t i = 0; i < 3; ++i) {
    store_le<float>(raw, 4 * i, rpy_deg[i]);
    store_le<std::int32_t>(raw, 12 + 4 * i, xyz_mm[i]);
  }
  return payload_of(raw);
}

std::optional<Sdk1Utc> Sdk1Utc::parse(std::span<const std::byte> payload) {
  if (payload.size() != 8) {
    return std::nullopt;
  }
  Sdk1Utc message;
  message.year = static_cast<std::uint16_t>(2000 + load_le<std::uint8_t>(payload, 0));
  message.month = load_le<std::uint8_t>(payload, 1);
  message.day = load_le<std::uint8_t>(payload, 2);
  message.hour = load_le<std::uint8_t>(payload, 3);
  message.in_hour_us = load_le<std::uint32_t>(payload, 4);
  return message;
}

Payload Sdk1Utc::bytes() const {
  std::array<std::byte, 8> raw{};
  store_le<std::uint8_t>(raw, 0, static_cast<std::uint8_t>(year - 2000));
  store_le<std::uint8_t>(raw, 1, month);
  store_le<std::uint8_t>(raw, 2, day);
  store_le<std::uint8_t>(raw, 3, hour);
  store_le<std::uint32_t>(raw, 4, in_hour_us);
  return payload_of(raw);
}

std::optional<Sdk1Parameter> Sdk1Parameter::parse(std::span<const std::byte> payload) {
  if (payload.size() != 5 || load_le<std::uint16_t>(payload, 2) != 1) {
    return std::nullopt;
  }
  return Sdk1Parameter{load_le<std::uint16_t>(payload, 0), load_le<std::uint8_t>(payload, 4)};
}

Payload Sdk1Parameter::bytes() const {
  std::array<std::byte, 5> raw{};
  store_le<std::uint16_t>(raw, 0, key);
  store_le<std::uint16_t>(raw, 2, 1);
  store_le<std::uint8_t>(raw, 4, value);
  return payload_of(raw);
}

std::optional<std::uint8_t> result_of(std::span<const std::byte> payload) {
  return payload.empty() ? std::nullopt : std::optional(load_le<std::uint8_t>(payload, 0));
}

Payload one_byte(std::uint8_t value) {
  Payload payload;
  payload.push_back(static_cast<std::byte>(value));
  return payload;
}

}  // namespace slamd::livox
