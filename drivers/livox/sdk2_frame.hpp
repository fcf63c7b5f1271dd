#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/livox/control_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"

namespace slamd::livox {

/// Source: livox-sdk2.md §3.
enum class Sdk2Command : std::uint16_t {
  kDiscovery = 0x0000,
  kSetParameters = 0x0100,
  kGetParameters = 0x0101,
  kStatePush = 0x0102,
  kReboot = 0x0200,
  kGpsTime = 0x0202,
};

/// Source: livox-sdk2.md §3.1.
enum class Sdk2Key : std::uint16_t {
  kPointType = 0x0000,
  kScanPattern = 0x0001,
  kPointSend = 0x0003,  // 0: send
  kStateDestination = 0x0005,
  kPointDestination = 0x0006,
  kImuDestination = 0x0007,
  kAttitude = 0x0012,
  kWorkMode = 0x001A,
  kImuEnable = 0x001C,
  kSerialNumber = 0x8000,
  kFirmware = 0x8002,
  kWorkState = 0x8006,
  kTemperature = 0x8007,  // 0.01 °C
  kPowerUps = 0x8008,
  kSyncType = 0x800C,
  kHealth = 0x8011,
};

/// A control frame; payload points into the bytes that it was read from.
struct Sdk2Frame {
  std::uint32_t sequence = 0;
  Sdk2Command command = Sdk2Command::kDiscovery;  // any 16 bits may come in
  bool ack = false;
  bool from_device = false;
  std::span<const std::byte> payload;
};

/// Reads the frame at the front of a datagram; size tells where another one would begin.
/// Errors: a refusal leaves frame and size untouched.
FrameResult parse_sdk2_frame(std::span<const std::byte> bytes, Sdk2Frame& frame, std::size_t& size);

/// Writes a frame with its checksums. The caller's payload fits into FrameBytes.
FrameBytes write_sdk2_frame(const Sdk2Frame& frame);

/// The answer to a discovery.
struct Sdk2Discovery {
  std::uint8_t result = 0;
  std::uint8_t device_type = 0;  // 9 Mid-360
  DeviceCode serial_number;
  std::uint32_t address = 0;  // host order
  std::uint16_t command_port = 0;

  static std::optional<Sdk2Discovery> parse(std::span<const std::byte> payload);
  Payload bytes() const;
};

/// Where a stream goes to, and from where.
struct Sdk2Destination {
  std::uint32_t host_address = 0;  // host order
  std::uint16_t host_port = 0;
  std::uint16_t device_port = 0;

  static std::optional<Sdk2Destination> parse(std::span<const std::byte> value);
  Payload bytes() const;
  bool operator==(const Sdk2Destination&) const = default;
};

/// The time of the last PPS edge.
struct Sdk2GpsTime {
  std::uint64_t utc_ns = 0;

  static std::optional<Sdk2GpsTime> parse(std::span<const std::byte> payload);
  Payload bytes() const;
};

/// One parameter of a list.
struct Sdk2Value {
  Sdk2Key key = Sdk2Key::kPointType;  // any 16 bits may come in
  std::span<const std::byte> bytes;

  /// The number in front of the value; nothing when the value is too short.
  std::optional<std::uint8_t> as_u8() const;
  std::optional<std::uint32_t> as_u32() const;
};

/// Goes through a list of parameters: their number is announced, each has key, length and bytes.
class Sdk2ValueReader {
 public:
  /// Of a state push or a setting: number and two reserved bytes in front.
  static Sdk2ValueReader of_push(std::span<const std::byte> payload) { return {payload, 0, 4}; }

  /// Of the answer to a question: result and number in front.
  static Sdk2ValueReader of_answer(std::span<const std::byte> payload) { return {payload, 1, 3}; }

  /// Gives the next parameter out; false at the end, or where the bytes contradict the lengths.
  bool next(Sdk2Value& value);

  /// Tells whether all that was announced has come, and nothing else.
  bool complete() const { return left_ == 0 && bytes_.empty() && good_; }

 private:
  Sdk2ValueReader(std::span<const std::byte> payload, std::size_t count_at, std::size_t begin);

  std::span<const std::byte> bytes_;
  std::size_t left_ = 0;
  bool good_ = false;
};

/// Builds lists of parameters.
class Sdk2ValueWriter {
 public:
  /// Of a setting or a state push.
  Sdk2ValueWriter();

  /// Of the answer to a question.
  explicit Sdk2ValueWriter(std::uint8_t result);

  void add(Sdk2Key key, std::span<const std::byte> value);
  void add(Sdk2Key key, std::uint8_t value) { add(key, one_byte(value).view()); }

  std::span<const std::byte> payload() const { return std::span(raw_).first(size_); }

 private:
  std::array<std::byte, 232> raw_{};
  std::size_t count_at_ = 0;
  std::size_t size_ = 0;
  std::uint16_t count_ = 0;
};

/// The first of a device's health codes that is not 0; 0: all is well.
std::uint32_t first_health_code(std::span<const std::byte> codes);

/// A question for parameters.
Payload sdk2_question(std::span<const Sdk2Key> keys);

}  // namespace slamd::livox
