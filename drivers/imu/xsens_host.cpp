#include "drivers/imu/xsens_host.hpp"

#include "core/base/bytes.hpp"

namespace slamd::imu {

void XsensHost::begin(int rate_hz, Stamp now, LineOutput& out) {
  state_ = DialogueState::kUnderWay;
  rate_hz_ = rate_hz;
  refused_ = false;
  go(Step::kGoToConfig, now, out);
}

void XsensHost::take(const XbusMessage& message, Stamp now, LineOutput& out) {
  if (step_ == Step::kEnded) {
    return;
  }
  if (message.id == xbus::kWakeUp) {
    out.send(write_xbus({xbus::kWakeUpAck, {}}).view());  // it has just been switched on, and stays in configuration
    go(Step::kGoToConfig, now, out);
  } else if (message.id == xbus::kError && step_ == Step::kConfigure) {
    refused_ = true;
    error_ = message.data.empty() ? std::uint8_t{0} : load_be<std::uint8_t>(message.data, 0);
    go(Step::kGoToMeasurement, now, out);
  } else if (message.id == command() + 1) {
    if (step_ == Step::kConfigure) {
      note_promise(message.data);
    }
    if (step_ == Step::kGoToMeasurement) {
      step_ = Step::kEnded;
      state_ = refused_ ? DialogueState::kRefused : DialogueState::kConfigured;
    } else {
      go(step_ == Step::kGoToConfig ? Step::kConfigure : Step::kGoToMeasurement, now, out);
    }
  }
}

void XsensHost::advance(Stamp now, LineOutput& out) {
  if (step_ == Step::kEnded || now < ask_again_) {
    return;
  }
  if (tries_ == kTries) {
    step_ = Step::kEnded;
    state_ = DialogueState::kMute;
    return;
  }
  send_step(now, out);
}

void XsensHost::go(Step step, Stamp now, LineOutput& out) {
  step_ = step;
  tries_ = 0;
  send_step(now, out);
}

void XsensHost::send_step(Stamp now, LineOutput& out) {
  ++tries_;
  ask_again_ = now + kAnswerWait;
  if (step_ != Step::kConfigure) {
    out.send(write_xbus({command(), {}}).view());
    return;
  }
  const auto rate_hz = static_cast<std::uint16_t>(rate_hz_);
  const XsensOutput outputs[] = {{mt::kPacketCounter, mt::kFastest},
                                 {mt::kSampleTimeFine, mt::kFastest},
                                 {mt::kAcceleration, rate_hz},
                                 {mt::kRateOfTurn, rate_hz},
                                 {mt::kStatusWord, mt::kFastest}};
  out.send(write_output_configuration(outputs).view());
}

/// The answer repeats the list with the rates that the device makes of it.
void XsensHost::note_promise(std::span<const std::byte> outputs) {
  for (; outputs.size() >= 4; outputs = outputs.subspan(4)) {
    if (load_be<std::uint16_t>(outputs, 0) == mt::kAcceleration) {
      rate_hz_ = load_be<std::uint16_t>(outputs, 2);
    }
  }
}

std::uint8_t XsensHost::command() const {
  switch (step_) {
    case Step::kGoToConfig: return xbus::kGoToConfig;
    case Step::kConfigure: return xbus::kSetOutputConfiguration;
    default: return xbus::kGoToMeasurement;
  }
}

}  // namespace slamd::imu
