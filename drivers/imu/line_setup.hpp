#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/stamp.hpp"
#include "drivers/transport/baud_hunt.hpp"
#include "drivers/imu/imu_stream.hpp"
#include "drivers/imu/line_output.hpp"
#include "drivers/imu/mip_host.hpp"
#include "drivers/imu/xsens_host.hpp"

namespace slamd::imu {

using transport::BaudHunt;

struct LineSetupConfig {
  Protocol protocol = Protocol::kCsv;
  int baud = 0;     // 0: is found
  int rate_hz = 0;  // samples that the sensor is told to send; 0: it is left as it is
};

/// The samples a second, rate_hz or a whole part of it, that a line carries with room to spare.
int fitting_rate_hz(int rate_hz, int baud, std::size_t sample_bytes);

/// Brings a serial line from "just opened" to "samples come": finds its rate and configures its sensor, as far as the
/// configuration wants either. Without thread, port or clock: bytes and time go in, a rate, bytes and events come out.
/// A sensor that sends but does not answer is taken as it is; one that is mute is asked again for ever.
/// Real-time: never allocates; O(bytes); one thread.
class LineSetup {
 public:
  explicit LineSetup(const LineSetupConfig& config) : config_(config) {}

  /// Begins anew: the port has been opened.
  void begin(Stamp now, LineOutput& out);

  /// Takes bytes until the line is ready; returns how many. The others belong to its samples.
  std::size_t receive(std::span<const std::byte> bytes, Stamp now, LineOutput& out);

  /// Lets time pass: call it at least every 100 ms.
  void advance(Stamp now, LineOutput& out);

  /// What the port is to be set to.
  int baud() const { return config_.baud != 0 ? config_.baud : hunt_.baud(); }
  bool is_ready() const { return state_ == State::kReady; }

 private:
  enum class State : std::uint8_t { kHunting, kTalking, kReady };

  bool can_talk() const { return config_.protocol != Protocol::kCsv && config_.rate_hz != 0; }
  void hunt(Stamp now);
  void take_byte(std::span<const std::byte> byte, Stamp now, LineOutput& out);
  void take(const XbusMessage& message, Stamp now, LineOutput& out);
  void take(const MipPacket& packet, Stamp now, LineOutput& out);
  void hear(bool answer, Stamp now, LineOutput& out);
  void probe(LineOutput& out) const;
  void talk(Stamp now, LineOutput& out);
  void look_at_dialogue(Stamp now, LineOutput& out);
  void forget_bytes();

  LineSetupConfig config_;
  State state_ = State::kReady;
  BaudHunt hunt_;
  XsensHost xsens_host_;
  MipHost mip_host_;
  ByteFrames<Xbus> xbus_;
  ByteFrames<Mip> mip_;
  CsvRows rows_;
  int samples_heard_ = 0;  // while talking
  int rounds_told_ = 0;
};

}  // namespace slamd::imu
