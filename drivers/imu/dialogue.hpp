#pragma once

#include <cstdint>

#include "core/base/stamp.hpp"

namespace slamd::imu {

/// How a conversation stands.
enum class DialogueState : std::uint8_t {
  kUnderWay,
  kConfigured,  // the sensor sends what it was told to
  kRefused,     // the sensor sends what it did before
  kMute,        // no answer to a command that was repeated
};

/// What the conversations with inertial sensors have in common: each command is repeated until it is answered, a few
/// times, and a refusal is kept until the sensor sends again.
/// Real-time: never allocates; one thread.
class Dialogue {
 public:
  static constexpr Duration kAnswerWait = std::chrono::milliseconds{300};
  static constexpr int kTries = 5;

  DialogueState state() const { return state_; }
  bool is_under_way() const { return state_ == DialogueState::kUnderWay; }

  /// kConfigured: the samples a second that the device has promised.
  int rate_hz() const { return rate_hz_; }

  /// kRefused: the code of the device's answer.
  std::uint8_t error() const { return error_; }

 protected:
  void begin() {
    state_ = DialogueState::kUnderWay;
    refused_ = false;
  }

  void promise(int rate_hz) { rate_hz_ = rate_hz; }

  void note_refusal(std::uint8_t code) {
    refused_ = true;
    error_ = code;
  }

  /// The next command is a new one, not a repetition.
  void begin_command() { tries_ = 0; }

  void note_sent(Stamp now) {
    ++tries_;
    ask_again_ = now + kAnswerWait;
  }

  /// Tells whether the command that waits for its answer is to be sent again. After the last try the device is mute.
  bool is_to_be_repeated(Stamp now) {
    if (!is_under_way() || now < ask_again_) {
      return false;
    }
    if (tries_ == kTries) {
      state_ = DialogueState::kMute;
    }
    return is_under_way();
  }

  /// The device sends again.
  void end() { state_ = refused_ ? DialogueState::kRefused : DialogueState::kConfigured; }

 private:
  DialogueState state_ = DialogueState::kMute;
  int rate_hz_ = 0;
  bool refused_ = false;
  std::uint8_t error_ = 0;
  int tries_ = 0;
  Stamp ask_again_{};
};

}  // namespace slamd::imu
