#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/fixed_vector.hpp"
#include "drivers/transport/byte_frames.hpp"
#include "drivers/imu/inertial_result.hpp"

namespace slamd::imu {

using transport::ByteFrames;
using transport::FrameVerdict;
using transport::FrameView;
using transport::StreamCounters;

/// A MIP packet; payload points into the bytes that it was read from. Source: imu-serial.md §B.1.
struct MipPacket {
  std::uint8_t set = 0;
  std::span<const std::byte> payload;
};

/// How MIP frames its packets, for ByteFrames.
struct Mip {
  static constexpr std::size_t kLongest = 4 + 255 + 2;

  static FrameView inspect(std::span<const std::byte> bytes);

  /// Reads the packet of a frame that inspect() has found good.
  static MipPacket parse(std::span<const std::byte> frame);
};

/// A packet on its way out.
using MipBytes = FixedVector<std::byte, Mip::kLongest>;

/// Writes a packet with its checksum.
MipBytes write_mip(const MipPacket& packet);

/// One field of a packet.
struct MipField {
  std::uint8_t descriptor = 0;
  std::span<const std::byte> data;
};

/// Goes through the fields of a packet; false at the end, and for good where the lengths contradict
/// the packet's (then malformed() says so).
class MipFields {
 public:
  explicit MipFields(std::span<const std::byte> payload) : rest_(payload) {}

  bool next(MipField& field);
  bool malformed() const { return malformed_; }

 private:
  std::span<const std::byte> rest_;
  bool malformed_ = false;
};

/// Numbers of sets, commands and fields. Source: imu-serial.md §B.2, §B.3.
namespace mip {
inline constexpr std::uint8_t kBaseCommands = 0x01;
inline constexpr std::uint8_t kPing = 0x01;
inline constexpr std::uint8_t kIdle = 0x02;
inline constexpr std::uint8_t kResume = 0x06;

inline constexpr std::uint8_t kSensorCommands = 0x0C;
inline constexpr std::uint8_t kBaseRate = 0x0E;
inline constexpr std::uint8_t kBaseRateReply = 0x8E;
inline constexpr std::uint8_t kMessageFormat = 0x0F;
inline constexpr std::uint8_t kDataStream = 0x11;
inline constexpr std::uint8_t kSet = 0x01;  // as a function
inline constexpr std::uint8_t kAckField = 0xF1;

inline constexpr std::uint8_t kSensorData = 0x80;
inline constexpr std::uint8_t kAcceleration = 0x04;
inline constexpr std::uint8_t kTurnRate = 0x05;
inline constexpr std::uint8_t kGpsTimestamp = 0x12;
inline constexpr std::uint8_t kOverrange = 0x18;
inline constexpr std::uint8_t kReferenceTime = 0xD5;
inline constexpr std::uint8_t kDeltaReferenceTime = 0xD6;
}  // namespace mip

/// One entry of a message format: what is sent, at the base rate over decimation.
struct MipOutput {
  std::uint8_t descriptor = 0;
  std::uint16_t decimation = 1;
};

/// Writes what a device is to send in its set of sensor data.
MipBytes write_message_format(std::span<const MipOutput> outputs);

/// A sample as a device has it.
struct MipSample {
  std::uint64_t reference_time_ns = 0;
  std::uint64_t since_last_ns = 0;
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rate_radps = Eigen::Vector3d::Zero();
  bool clipped = false;
};

/// Writes the packet of a sample with the fields that are asked for, in their order; those that a MipSample does not
/// have are left out. For emulators and tests.
MipBytes write_sample(std::span<const MipOutput> outputs, const MipSample& sample);

/// The device's answer to a command.
struct MipAck {
  std::uint8_t command = 0;
  std::uint8_t code = 0;  // 0 is success
};

/// Finds the answer to a command in a packet of a command set.
std::optional<MipAck> ack_of(const MipPacket& packet);

/// Decodes the stream of a MicroStrain sensor (MIP, sensor data set) into inertial samples.
///
/// A sample's time is the reference time (nanoseconds since power-up); without it GPS time, counted
/// from the GPS epoch. The device's own delta of that time tells how many samples are missing.
/// Acceleration comes in g and is given in m/s²; these sensors' z axis points down.
/// Threads: one, but the frames' counters are for any.  Real-time: never allocates; O(bytes).
class MipReader {
 public:
  /// Takes the next bytes; calls visit(const sensor::ImuReading&) for each sample.
  template <typename Visit>
  void add(std::span<const std::byte> bytes, Stamp received, Visit&& visit) {
    frames_.add(bytes, [&](std::span<const std::byte> frame) { take(frame, received, visit); });
  }

  /// Ends the stream, which was interrupted: calls visit() for the samples that were still in hand.
  template <typename Visit>
  void finish(Stamp received, Visit&& visit) {
    frames_.finish([&](std::span<const std::byte> frame) { take(frame, received, visit); });
  }

  /// Decodes one packet; counts what became of it.
  InertialResult take(const MipPacket& packet, sensor::ImuReading& reading);

  std::size_t pending() const { return frames_.pending(); }
  StreamCounters stream() const { return frames_.counters(); }
  const InertialCounters& counters() const { return counters_; }

  /// The last answer to a command that was a refusal.
  std::optional<MipAck> refusal() const { return refusal_; }

 private:
  struct Contents;

  template <typename Visit>
  void take(std::span<const std::byte> frame, Stamp received, Visit& visit) {
    sensor::ImuReading reading;
    if (take(Mip::parse(frame), reading) == InertialResult::kSample) {
      reading.received = received;
      visit(static_cast<const sensor::ImuReading&>(reading));
    }
  }

  InertialResult decode(const MipPacket& packet, sensor::ImuReading& reading);
  void note_gap(DeviceStamp stamp, std::optional<std::uint64_t> delta_ns);

  ByteFrames<Mip> frames_;
  std::optional<DeviceStamp> last_;
  std::optional<MipAck> refusal_;
  InertialCounters counters_;
};

}  // namespace slamd::imu
