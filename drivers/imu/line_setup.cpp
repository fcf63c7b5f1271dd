#include "drivers/imu/line_setup.hpp"

namespace slamd::imu {

int fitting_rate_hz(int rate_hz, int baud, std::size_t sample_bytes) {
  constexpr int kBitsPerByte = 10;
  constexpr double kShare = 0.9;
  for (const int part : {1, 2, 4, 5, 8, 10, 20, 40}) {
    const double bits = static_cast<double>(sample_bytes) * kBitsPerByte * rate_hz / part;
    if (rate_hz % part == 0 && bits <= kShare * baud) {
      return rate_hz / part;
    }
  }
  return 1;
}

void LineSetup::begin(Stamp now, LineOutput& out) {
  forget_bytes();
  if (config_.baud == 0) {
    hunt(now);
  } else if (can_talk()) {
    talk(now, out);
  } else {
    state_ = State::kReady;
  }
}

std::size_t LineSetup::receive(std::span<const std::byte> bytes, Stamp now, LineOutput& out) {
  // One after the other: what comes behind the last answer is the first sample.
  std::size_t taken = 0;
  while (taken < bytes.size() && !is_ready()) {
    take_byte(bytes.subspan(taken, 1), now, out);
    ++taken;
  }
  return taken;
}

void LineSetup::advance(Stamp now, LineOutput& out) {
  if (state_ == State::kHunting) {
    if (hunt_.take_probe(now)) {
      probe(out);
    }
    if (hunt_.advance(now)) {
      forget_bytes();
    }
    if (hunt_.rounds() > rounds_told_) {
      rounds_told_ = hunt_.rounds();
      out.tell(LineEvent::Kind::kMute);
    }
  } else if (state_ == State::kTalking) {
    if (config_.protocol == Protocol::kXsens) {
      xsens_host_.advance(now, out);
    } else {
      mip_host_.advance(now, out);
    }
    look_at_dialogue(now, out);
  }
}

void LineSetup::hunt(Stamp now) {
  state_ = State::kHunting;
  rounds_told_ = 0;
  hunt_.begin(now);
}

void LineSetup::take_byte(std::span<const std::byte> byte, Stamp now, LineOutput& out) {
  switch (config_.protocol) {
    case Protocol::kCsv:
      rows_.add_stream(byte, now, [&](const sensor::ImuReading&) { hear(false, now, out); });
      break;
    case Protocol::kXsens:
      xbus_.add(byte, [&](std::span<const std::byte> frame) { take(Xbus::parse(frame), now, out); });
      break;
    case Protocol::kMip:
      mip_.add(byte, [&](std::span<const std::byte> frame) { take(Mip::parse(frame), now, out); });
      break;
    case Protocol::kAceinna: break;  // speaks on CAN only
  }
}

void LineSetup::take(const XbusMessage& message, Stamp now, LineOutput& out) {
  if (state_ == State::kTalking) {
    samples_heard_ += message.id == xbus::kMtData2 ? 1 : 0;
    xsens_host_.take(message, now, out);
    look_at_dialogue(now, out);
  } else {
    hear(message.id == xbus::kGoToConfig + 1 || message.id == xbus::kGoToMeasurement + 1, now, out);
  }
}

void LineSetup::take(const MipPacket& packet, Stamp now, LineOutput& out) {
  if (state_ == State::kTalking) {
    samples_heard_ += packet.set == mip::kSensorData ? 1 : 0;
    mip_host_.take(packet, now, out);
    look_at_dialogue(now, out);
  } else {
    hear(ack_of(packet).has_value(), now, out);
  }
}

/// A good frame, perhaps the answer to a probe, while the rate is looked for.
void LineSetup::hear(bool answer, Stamp now, LineOutput& out) {
  if (state_ != State::kHunting) {
    return;
  }
  if (answer) {
    hunt_.hear_answer();
  } else {
    hunt_.hear(now);
  }
  if (!hunt_.found()) {
    return;
  }
  out.tell(LineEvent::Kind::kFound, static_cast<std::uint32_t>(hunt_.baud()));
  if (can_talk()) {
    talk(now, out);
  } else {
    state_ = State::kReady;
  }
}

/// Something that the sensor answers in any state, and that leaves it where it is to go anyway.
void LineSetup::probe(LineOutput& out) const {
  if (config_.protocol == Protocol::kXsens) {
    out.send(write_xbus({can_talk() ? xbus::kGoToConfig : xbus::kGoToMeasurement, {}}).view());
  } else if (config_.protocol == Protocol::kMip) {
    const std::byte field[] = {std::byte{2}, std::byte{can_talk() ? mip::kPing : mip::kResume}};
    out.send(write_mip({mip::kBaseCommands, field}).view());
  }
}

void LineSetup::talk(Stamp now, LineOutput& out) {
  state_ = State::kTalking;
  samples_heard_ = 0;
  if (config_.protocol == Protocol::kXsens) {
    xsens_host_.begin(fitting_rate_hz(config_.rate_hz, baud(), XsensHost::kSampleBytes), now, out);
  } else {
    mip_host_.begin(fitting_rate_hz(config_.rate_hz, baud(), MipHost::kSampleBytes), now, out);
  }
}

void LineSetup::look_at_dialogue(Stamp now, LineOutput& out) {
  const Dialogue& dialogue = config_.protocol == Protocol::kXsens ? static_cast<const Dialogue&>(xsens_host_) : mip_host_;
  switch (dialogue.state()) {
    case DialogueState::kUnderWay: break;
    case DialogueState::kConfigured:
      state_ = State::kReady;
      out.tell(LineEvent::Kind::kConfigured, static_cast<std::uint32_t>(dialogue.rate_hz()));
      break;
    case DialogueState::kRefused:
      state_ = State::kReady;
      out.tell(LineEvent::Kind::kRefused, dialogue.error());
      break;
    case DialogueState::kMute:
      if (samples_heard_ >= BaudHunt::kFrames) {
        state_ = State::kReady;
        out.tell(LineEvent::Kind::kTakenAsItIs);
      } else {
        out.tell(LineEvent::Kind::kMute);
        if (config_.baud == 0) {
          hunt(now);
        } else {
          talk(now, out);
        }
      }
      break;
  }
}

void LineSetup::forget_bytes() {
  xbus_.restart();
  mip_.restart();
  rows_.restart_stream();
}

}  // namespace slamd::imu
