#include "drivers/imu/xsens_host.hpp"

#include "core/base/bytes.hpp"

namespace slamd::imu {

void XsensHost::begin(int rate_hz, Stamp now, LineOutput& out) {
  Dialogue::begin();
  promise(rate_hz);
  go(Step::kGoToConfig, now, out);
}

void XsensHost::take(const XbusMessage& message, Stamp now, LineOutput& out) {
  if (!is_under_way()) {
    return;
  }
  if (message.id == xbus::kWakeUp) {
    out.send(write_xbus({xbus::kWakeUpAck, {}}).view());  // it has just been switched on, and stays in configuration
    go(Step::kGoToConfig, now, out);
  } else if (message.id == xbus::kError && step_ == Step::kConfigure) {
    note_refusal(message.data.empty() ? std::uint8_t{0} : load_be<std::uint8_t>(message.data, 0));
    go(Step::kGoToMeasurement, now, out);
  } else if (message.id == command() + 1) {
    if (step_ == Step::kConfigure) {
      note_promise(message.data);
    }
    if (step_ == Step::kGoToMeasurement) {
      end();
    } else {
      go(step_ == Step::kGoToConfig ? Step::kConfigure : Step::kGoToMeasurement, now, out);
    }
  }
}

void XsensHost::advance(Stamp now, LineOutput& out) {
  if (is_to_be_repeated(now)) {
    send_step(now, out);
  }
}

void XsensHost::go(Step step, Stamp now, LineOutput& out) {
  step_ = step;
  begin_command();
  send_step(now, out);
}

void XsensHost::send_step(Stamp now, LineOutput& out) {
  note_sent(now);
  if (step_ != Step::kConfigure) {
    out.send(write_xbus({command(), {}}).view());
    return;
  }
  const auto measured_hz = static_cast<std::uint16_t>(rate_hz());
  const XsensOutput outputs[] = {{mt::kPacketCounter, mt::kFastest},
                                 {mt::kSampleTimeFine, mt::kFastest},
                                 {mt::kAcceleration, measured_hz},
                                 {mt::kRateOfTurn, measured_hz},
                                 {mt::kStatusWord, mt::kFastest}};
  out.send(write_output_configuration(outputs).view());
}

/// The answer repeats the list with the rates that the device makes of it.
void XsensHost::note_promise(std::span<const std::byte> outputs) {
  for (; outputs.size() >= 4; outputs = outputs.subspan(4)) {
    if (load_be<std::uint16_t>(outputs, 0) == mt::kAcceleration) {
      promise(load_be<std::uint16_t>(outputs, 2));
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
