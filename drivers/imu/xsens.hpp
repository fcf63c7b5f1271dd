#pragma once

#include <array>
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

/// An XBus message; data points into the bytes that it was read from. Source: imu-serial.md §A.1.
struct XbusMessage {
  std::uint8_t id = 0;
  std::span<const std::byte> data;
};

/// Source: imu-serial.md §A.2. An answer has the command's number plus one.
namespace xbus {
inline constexpr std::uint8_t kRequestDeviceId = 0x00;
inline constexpr std::uint8_t kGoToMeasurement = 0x10;
inline constexpr std::uint8_t kGoToConfig = 0x30;
inline constexpr std::uint8_t kMtData2 = 0x36;
inline constexpr std::uint8_t kWakeUp = 0x3E;
inline constexpr std::uint8_t kWakeUpAck = 0x3F;
inline constexpr std::uint8_t kError = 0x42;
inline constexpr std::uint8_t kSetOutputConfiguration = 0xC0;
}  // namespace xbus

/// What SetOutputConfiguration asks for; the two lowest bits choose the number format. Source: imu-serial.md §A.3.
namespace mt {
inline constexpr std::uint16_t kPacketCounter = 0x1020;
inline constexpr std::uint16_t kSampleTimeFine = 0x1060;
inline constexpr std::uint16_t kAcceleration = 0x4020;
inline constexpr std::uint16_t kRateOfTurn = 0x8020;
inline constexpr std::uint16_t kStatusWord = 0xE020;
inline constexpr std::uint16_t kFastest = 0xFFFF;  // as a rate: with each message
}  // namespace mt

/// How XBus frames the messages of a device on a line of its own, for ByteFrames.
struct Xbus {
  static constexpr std::size_t kLongest = 2048 + 7;

  static FrameView inspect(std::span<const std::byte> bytes);

  /// Reads the message of a frame that inspect() has found good.
  static XbusMessage parse(std::span<const std::byte> frame);
};

/// A message on its way out.
using XbusBytes = FixedVector<std::byte, 320>;

/// Writes a message with its checksum. The caller's data fit into XbusBytes.
XbusBytes write_xbus(const XbusMessage& message);

/// One entry of SetOutputConfiguration.
struct XsensOutput {
  std::uint16_t data_id = 0;
  std::uint16_t rate_hz = 0;  // 0xFFFF: as fast as it goes
};

/// Writes what a device is to send.
XbusBytes write_output_configuration(std::span<const XsensOutput> outputs);

/// A sample as a device has it.
struct XsensSample {
  std::uint16_t count = 0;
  std::uint32_t ticks = 0;  // of 0.1 ms
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rate_radps = Eigen::Vector3d::Zero();
  bool clipped = false;
};

/// Writes the MTData2 message of a sample with the items that are asked for, in their order and number formats; those
/// that an XsensSample does not have are left out. For emulators and tests.
XbusBytes write_sample(std::span<const XsensOutput> outputs, const XsensSample& sample);

/// One item of an MTData2 message. Source: imu-serial.md §A.3.
struct MtItem {
  /// Without the bits of coordinate system and number format.
  std::uint16_t type = 0;
  std::uint8_t format = 0;  // 0 float, 1 FP12.20, 2 FP16.32, 3 double
  std::span<const std::byte> data;

  /// The item as three numbers; nothing when it has another length.
  std::optional<std::array<double, 3>> as_vector() const;
};

/// Goes through the items of an MTData2 message; false at the end, and for good where the lengths
/// contradict the message's (then malformed() says so).
class MtItems {
 public:
  explicit MtItems(std::span<const std::byte> data) : rest_(data) {}

  bool next(MtItem& item);
  bool malformed() const { return malformed_; }

 private:
  std::span<const std::byte> rest_;
  bool malformed_ = false;
};

/// Decodes the stream of an Xsens MTi (MTData2, all four number formats) into inertial samples.
///
/// A sample's time is SampleTimeFine, 0.1 ms ticks, carried on over its wrap after five days; without
/// it, the packet counter's times the configured period. Gaps of the packet counter are counted.
/// Acceleration is specific force as it comes: (0, 0, +9.81) at rest and level.
/// Threads: one, but the frames' counters are for any.  Real-time: never allocates; O(bytes).
class XsensReader {
 public:
  /// period: of the samples, for devices that do not send SampleTimeFine; zero: they must.
  explicit XsensReader(Duration period = Duration::zero()) : period_(period) {}

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

  /// Decodes one message; counts what became of it.
  InertialResult take(const XbusMessage& message, sensor::ImuReading& reading);

  std::size_t pending() const { return frames_.pending(); }
  StreamCounters stream() const { return frames_.counters(); }
  const InertialCounters& counters() const { return counters_; }

  /// The last error that the device reported by itself.
  std::optional<std::uint8_t> device_error() const { return device_error_; }

 private:
  struct Contents;

  template <typename Visit>
  void take(std::span<const std::byte> frame, Stamp received, Visit& visit) {
    sensor::ImuReading reading;
    if (take(Xbus::parse(frame), reading) == InertialResult::kSample) {
      reading.received = received;
      visit(static_cast<const sensor::ImuReading&>(reading));
    }
  }

  InertialResult decode(const XbusMessage& message, sensor::ImuReading& reading);
  std::optional<DeviceStamp> stamp_of(const Contents& contents);

  ByteFrames<Xbus> frames_;
  Duration period_;
  std::optional<std::uint32_t> last_ticks_;
  std::optional<std::uint16_t> last_count_;
  std::int64_t ticks_ = 0;   // carried on over the wrap
  std::int64_t samples_ = 0;  // likewise, of the packet counter
  std::optional<std::uint8_t> device_error_;
  InertialCounters counters_;
};

}  // namespace slamd::imu
