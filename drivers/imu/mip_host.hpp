#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/stamp.hpp"
#include "drivers/imu/dialogue.hpp"
#include "drivers/imu/line_output.hpp"
#include "drivers/imu/mip.hpp"

namespace slamd::imu {

/// The host's side of the conversation that makes a MicroStrain sensor send samples (imu-serial.md §B.2), without
/// thread, port or clock: idle, base rate, message format, data stream, resume, each repeated until it is answered.
/// A field that the model does not have is left out; one that does not tell its base rate is resumed as it was.
/// Real-time: never allocates; one thread.
class MipHost : public Dialogue {
 public:
  static constexpr std::size_t kSampleBytes = 58;  // of the packet that is asked for first

  enum class Step : std::uint8_t { kIdle, kBaseRate, kFormat, kStream, kResume, kEnded };

  /// Begins the conversation, whatever the device is at; it is to send about rate_hz samples a second.
  void begin(int rate_hz, Stamp now, LineOutput& out);

  /// Takes a packet of the device.
  void take(const MipPacket& packet, Stamp now, LineOutput& out);

  /// Lets time pass: call it at least every 100 ms.
  void advance(Stamp now, LineOutput& out);

  Step step() const { return is_under_way() ? step_ : Step::kEnded; }

 private:
  void go(Step step, Stamp now, LineOutput& out);
  void go_on(Stamp now, LineOutput& out);
  void refuse(std::uint8_t code, Stamp now, LineOutput& out);
  void send_step(Stamp now, LineOutput& out);
  bool read_base_rate(const MipPacket& packet);
  std::uint8_t command() const;

  Step step_ = Step::kEnded;
  int wanted_hz_ = 0;
  std::uint16_t decimation_ = 1;
  std::size_t format_ = 0;  // which of the formats, the richest first
};

}  // namespace slamd::imu
