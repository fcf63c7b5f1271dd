#pragma once

#include <cstdint>

#include "core/base/stamp.hpp"
#include "drivers/imu/dialogue.hpp"
#include "drivers/imu/line_output.hpp"
#include "drivers/imu/xsens.hpp"

namespace slamd::imu {

/// The host's side of the conversation that makes an Xsens MTi send samples (imu-serial.md §A.2), without thread, port
/// or clock: GoToConfig, SetOutputConfiguration, GoToMeasurement, each repeated until it is answered.
/// Real-time: never allocates; one thread.
class XsensHost : public Dialogue {
 public:
  static constexpr std::size_t kSampleBytes = 54;  // of the message that is asked for

  enum class Step : std::uint8_t { kGoToConfig, kConfigure, kGoToMeasurement, kEnded };

  /// Begins the conversation, whatever the device is at; it is to send rate_hz samples a second.
  void begin(int rate_hz, Stamp now, LineOutput& out);

  /// Takes a message of the device.
  void take(const XbusMessage& message, Stamp now, LineOutput& out);

  /// Lets time pass: call it at least every 100 ms.
  void advance(Stamp now, LineOutput& out);

  Step step() const { return is_under_way() ? step_ : Step::kEnded; }

 private:
  void go(Step step, Stamp now, LineOutput& out);
  void send_step(Stamp now, LineOutput& out);
  void note_promise(std::span<const std::byte> outputs);
  std::uint8_t command() const;

  Step step_ = Step::kEnded;
};

}  // namespace slamd::imu
