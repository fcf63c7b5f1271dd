#pragma once

#include <cstdint>

#include "core/base/stamp.hpp"
#include "drivers/imu/line_output.hpp"
#include "drivers/imu/xsens.hpp"

namespace slamd::imu {

/// The host's side of the conversation that makes an Xsens MTi send samples (imu-serial.md §A.2), without thread, port
/// or clock: GoToConfig, SetOutputConfiguration, GoToMeasurement, each repeated until it is answered.
/// Real-time: never allocates; one thread.
class XsensHost {
 public:
  static constexpr Duration kAnswerWait = std::chrono::milliseconds{300};
  static constexpr int kTries = 5;
  static constexpr std::size_t kSampleBytes = 54;  // of the message that is asked for

  enum class Step : std::uint8_t { kGoToConfig, kConfigure, kGoToMeasurement, kEnded };

  /// Begins the conversation, whatever the device is at; it is to send rate_hz samples a second.
  void begin(int rate_hz, Stamp now, LineOutput& out);

  /// Takes a message of the device.
  void take(const XbusMessage& message, Stamp now, LineOutput& out);

  /// Lets time pass: call it at least every 100 ms.
  void advance(Stamp now, LineOutput& out);

  Step step() const { return step_; }
  DialogueState state() const { return state_; }

  /// kConfigured: the samples a second that the device has promised.
  int rate_hz() const { return rate_hz_; }

  /// kRefused: the device's error.
  std::uint8_t error() const { return error_; }

 private:
  void go(Step step, Stamp now, LineOutput& out);
  void send_step(Stamp now, LineOutput& out);
  void note_promise(std::span<const std::byte> outputs);
  std::uint8_t command() const;

  Step step_ = Step::kEnded;
  DialogueState state_ = DialogueState::kMute;
  int rate_hz_ = 0;
  std::uint8_t error_ = 0;
  bool refused_ = false;
  int tries_ = 0;
  Stamp ask_again_{};
};

}  // namespace slamd::imu
