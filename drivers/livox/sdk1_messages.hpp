#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/fixed_vector.hpp"

namespace slamd::livox {

// What the control frames of SDK1 carry. Source: livox-sdk1.md §3.1, §4.
// Each parse() returns nothing when the length is not the message's; each bytes() is its inverse.

/// Bytes of one message.
using Payload = FixedVector<std::byte, 64>;

/// A name of up to 16 characters, filled up with zeros.
struct DeviceCode {
  std::array<char, 16> characters{};

  std::string_view view() const;
  static DeviceCode of(std::string_view text);
  bool operator==(const DeviceCode&) const = default;
};

/// The device looks for a host.
struct Sdk1Broadcast {
  DeviceCode code;
  std::uint8_t device_type = 0;
  std::uint16_t reserved = 0;

  static std::optional<Sdk1Broadcast> parse(std::span<const std::byte> payload);
  Payload bytes() const;
};

/// The host says who it is and where it wants the data.
struct Sdk1Handshake {
  std::uint32_t host_address = 0;  // host order
  std::uint16_t data_port = 0;
  std::uint16_t command_port = 0;
  std::optional<std::uint16_t> imu_port;  // firmware without inertial sensor knows none

  static std::optional<Sdk1Handshake> parse(std::span<const std::byte> payload);
  Payload bytes() const;
};

/// What the device is about.
enum class Sdk1WorkState : std::uint8_t { kInitialising, kNormal, kPowerSaving, kStandby, kError, kUnknown };

/// The answer to a heartbeat.
struct Sdk1HeartbeatAck {
  std::uint8_t result = 0;
  Sdk1WorkState state = Sdk1WorkState::kUnknown;  // kUnknown for values that are not defined
  std::uint8_t features = 0;
  std::uint32_t status_or_progress = 0;  // progress in % while initialising, else the status code

  static std::optional<Sdk1HeartbeatAck> parse(std::span<const std::byte> payload);
  Payload bytes() const;
};

struct Sdk1DeviceInfo {
  std::uint8_t result = 0;
  std::array<std::uint8_t, 4> firmware{};

  static std::optional<Sdk1DeviceInfo> parse(std::span<const std::byte> payload);
  Payload bytes() const;
};

/// Where the device was told that it sits: R = Rz(yaw)·Ry(pitch)·Rx(roll), p' = R p + t.
struct Sdk1Extrinsic {
  std::array<float, 3> rpy_deg{};
  std::array<std::int32_t, 3> xyz_mm{};

  /// Of the 24 bytes alone; an answer has its result in front of them.
  static std::optional<Sdk1Extrinsic> parse(std::span<const std::byte> payload);
  Payload bytes() const;
  bool operator==(const Sdk1Extrinsic&) const = default;
};

/// The hour that the last PPS edge lay in, and where.
struct Sdk1Utc {
  std::uint16_t year = 2000;
  std::uint8_t month = 1;
  std::uint8_t day = 1;
  std::uint8_t hour = 0;
  std::uint32_t in_hour_us = 0;

  static std::optional<Sdk1Utc> parse(std::span<const std::byte> payload);
  Payload bytes() const;
  bool operator==(const Sdk1Utc&) const = default;
};

/// One of the parameters that are written and read by key.
struct Sdk1Parameter {
  std::uint16_t key = 0;
  std::uint8_t value = 0;

  static std::optional<Sdk1Parameter> parse(std::span<const std::byte> payload);
  Payload bytes() const;
};

/// The first byte of most answers: 0 is success.
std::optional<std::uint8_t> result_of(std::span<const std::byte> payload);

/// A message of one byte: start, coordinate, mode, rate; or an answer with nothing but its result.
Payload one_byte(std::uint8_t value);

}  // namespace slamd::livox
