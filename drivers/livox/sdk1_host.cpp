#include "drivers/livox/sdk1_host.hpp"

#include "core/base/bytes.hpp"

namespace slamd::livox {

namespace {

constexpr std::uint8_t kSwitching = 2;  // the answer to a mode that takes a while

Sdk1WorkState work_state_of(Sdk1Mode mode) { return static_cast<Sdk1WorkState>(mode); }

/// Indexed by Sdk1HostState.
constexpr std::string_view kStateNames[] = {"searching", "handshaking", "waiting", "configuring", "sampling",
                                            "resting",   "stopped"};

}  // namespace

std::string_view name_of(Sdk1HostState state) { return kStateNames[static_cast<std::size_t>(state)]; }

Sdk1Host::Sdk1Host(const Sdk1HostConfig& config)
    : config_(config), conversation_({config.device, config.interfaces, 0xFFFF, kAnswerWait, kLostAfter}) {}

std::string_view Sdk1Host::state_name() const { return name_of(state_); }

bool Sdk1Host::is_connected() const {
  return state_ != Sdk1HostState::kSearching && state_ != Sdk1HostState::kHandshaking &&
         state_ != Sdk1HostState::kStopped;
}

void Sdk1Host::receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out) {
  conversation_.read<Sdk1Frame>(datagram, parse_sdk1_frame,
                                [&](const Sdk1Frame& frame) { take_frame(frame, from, now, out); });
}

void Sdk1Host::take_frame(const Sdk1Frame& frame, Endpoint from, Stamp now, HostOutput& out) {
  if (state_ == Sdk1HostState::kStopped) {
    return;
  }
  if (frame.command == Sdk1Command::kBroadcast && frame.type == Sdk1FrameType::kMessage) {
    take_broadcast(frame, from, now, out);
    return;
  }
  if (state_ == Sdk1HostState::kSearching || !conversation_.is_with(from)) {
    conversation_.count_stranger();
    return;
  }
  if (frame.command == Sdk1Command::kAbnormalStatus && frame.type == Sdk1FrameType::kMessage && is_connected()) {
    if (frame.payload.size() == 4) {
      note_status(load_le<std::uint32_t>(frame.payload, 0), out);
    } else {
      conversation_.count_unexpected();
    }
    return;
  }
  if (frame.type != Sdk1FrameType::kAck) {
    conversation_.count_unexpected();
    return;
  }
  if (frame.command == Sdk1Command::kHeartbeat && is_connected()) {
    take_heartbeat_ack(frame, now, out);
  } else if (frame.command == Sdk1Command::kSetUtc && is_connected()) {
    take_utc_ack(frame, out);
  } else if (!conversation_.answers(frame.sequence) || frame.payload.empty()) {
    conversation_.count_unexpected();  // late, or somebody else's
  } else if (state_ == Sdk1HostState::kHandshaking) {
    take_handshake_ack(frame, now, out);
  } else if (asked_mode_) {
    take_mode_ack(frame, now, out);
  } else {
    take_step_ack(frame, now, out);
  }
}

void Sdk1Host::take_utc_ack(const Sdk1Frame& frame, HostOutput& out) {
  const std::uint8_t result = result_of(frame.payload).value_or(1);
  if (result == 0) {
    conversation_.tell(HostEventKind::kTimeSet, out);
  } else {
    tell_result(result, Sdk1Command::kSetUtc, out);
  }
}

void Sdk1Host::take_broadcast(const Sdk1Frame& frame, Endpoint from, Stamp now, HostOutput& out) {
  const std::optional<Sdk1Broadcast> broadcast = Sdk1Broadcast::parse(frame.payload);
  if (!broadcast) {
    conversation_.count_unexpected();
    return;
  }
  if (!conversation_.wants(broadcast->code) || (is_connected() && broadcast->code != code())) {
    conversation_.count_stranger();
    return;
  }
  if (is_connected()) {
    if (now - connected_since_ < kStaleBroadcast) {
      return;
    }
    conversation_.tell(HostEventKind::kRestarted, out);  // a device that has a host does not look for one
    search();
  }
  if (state_ == Sdk1HostState::kHandshaking) {
    return;  // the answer is on its way, or asked for again in time
  }
  if (!conversation_.meet(broadcast->code, from, out)) {
    return;
  }
  if (!told_held_) {
    conversation_.tell(HostEventKind::kFound, out);
  }
  state_ = Sdk1HostState::kHandshaking;
  conversation_.begin();
  handshake(now, out);
}

void Sdk1Host::handshake(Stamp now, HostOutput& out) {
  Sdk1Handshake message;
  message.host_address = conversation_.host_address();
  message.data_port = config_.data_port;
  message.command_port = config_.command_port;
  message.imu_port = config_.imu_port;
  conversation_.expect(send(Sdk1Command::kHandshake, message.bytes().view(), out), now);
}

void Sdk1Host::take_handshake_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out) {
  if (frame.command != Sdk1Command::kHandshake) {
    conversation_.count_unexpected();
    return;
  }
  conversation_.settle();
  if (*result_of(frame.payload) != 0) {
    if (!told_held_) {
      told_held_ = true;
      conversation_.tell(HostEventKind::kHeldByOther, out);
    }
    search();  // its next broadcast is the next try
    return;
  }
  told_held_ = false;
  disowned_ = false;
  state_ = Sdk1HostState::kWaiting;
  connected_since_ = now;
  conversation_.hear(now);
  conversation_.be_due_at(now);
  work_.reset();
  progress_.reset();
  status_.reset();
  extrinsic_.reset();
  conversation_.tell(HostEventKind::kConnected, out);
  heartbeat(now, out);
}

void Sdk1Host::heartbeat(Stamp now, HostOutput& out) {
  send(Sdk1Command::kHeartbeat, {}, out);
  next_heartbeat_ = now + kHeartbeatEvery;
}

void Sdk1Host::take_heartbeat_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out) {
  const std::optional<Sdk1HeartbeatAck> ack = Sdk1HeartbeatAck::parse(frame.payload);
  if (!ack) {
    conversation_.count_unexpected();
    return;
  }
  if (ack->result != 0) {
    disowned_ = true;  // three seconds of that are a loss
    return;
  }
  disowned_ = false;
  conversation_.hear(now);
  if (ack->state == Sdk1WorkState::kInitialising) {
    if (progress_ != ack->status_or_progress) {
      progress_ = ack->status_or_progress;
      conversation_.tell(HostEventKind::kInitialising, out, ack->status_or_progress);
    }
  } else {
    note_status(ack->status_or_progress, out);
  }
  note_state(ack->state, now, out);
}

void Sdk1Host::note_status(std::uint32_t code, HostOutput& out) {
  if (status_ != code) {
    status_ = code;
    conversation_.tell(HostEventKind::kStatusChanged, out, code);
  }
}

void Sdk1Host::note_state(Sdk1WorkState work, Stamp now, HostOutput& out) {
  if (work_ != work) {
    work_ = work;
    conversation_.tell(HostEventKind::kStateChanged, out, static_cast<std::uint32_t>(work));
  }
  const bool there = work == work_state_of(mode_);
  if (there && mode_ == Sdk1Mode::kNormal) {
    if (state_ == Sdk1HostState::kWaiting || state_ == Sdk1HostState::kResting) {
      conversation_.settle();
      begin_step(Sdk1Step::kDeviceInfo, now, out);
    }
    return;
  }
  if (there) {
    conversation_.settle();
    state_ = Sdk1HostState::kResting;
    return;
  }
  if (state_ != Sdk1HostState::kWaiting) {
    conversation_.settle();
    state_ = Sdk1HostState::kWaiting;
  }
  const bool may_switch = work == Sdk1WorkState::kNormal || work == Sdk1WorkState::kPowerSaving ||
                          work == Sdk1WorkState::kStandby;
  if (may_switch && !conversation_.is_waiting() && conversation_.is_due(now)) {  // not again with each answer
    conversation_.begin();
    ask_for_mode(now, out);
  }
}

void Sdk1Host::ask_for_mode(Stamp now, HostOutput& out) {
  asked_mode_ = true;
  conversation_.expect(send(Sdk1Command::kSetMode, one_byte(static_cast<std::uint8_t>(mode_)).view(), out), now);
}

void Sdk1Host::take_mode_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out) {
  if (frame.command != Sdk1Command::kSetMode) {
    conversation_.count_unexpected();
    return;
  }
  conversation_.settle();
  asked_mode_ = false;
  const std::uint8_t result = *result_of(frame.payload);
  if (result != 0 && result != kSwitching) {
    tell_result(result, Sdk1Command::kSetMode, out);
  }
  heartbeat(now, out);  // its answer tells the new state
}

void Sdk1Host::begin_step(Sdk1Step step, Stamp now, HostOutput& out) {
  state_ = Sdk1HostState::kConfiguring;
  asked_mode_ = false;
  step_ = wanted_from(step, config_);
  if (step_ == Sdk1Step::kDone) {
    conversation_.settle();
    state_ = Sdk1HostState::kSampling;
    conversation_.tell(HostEventKind::kSampling, out);
    return;
  }
  conversation_.begin();
  send_step(now, out);
}

void Sdk1Host::send_step(Stamp now, HostOutput& out) {
  conversation_.expect(send(command_of(step_), payload_of(step_, config_).view(), out), now);
}

void Sdk1Host::take_step_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out) {
  if (state_ != Sdk1HostState::kConfiguring || frame.command != command_of(step_)) {
    conversation_.count_unexpected();
    return;
  }
  const std::uint8_t result = *result_of(frame.payload);
  if (result != 0) {
    tell_result(result, frame.command, out);
    if (step_ == Sdk1Step::kStart) {
      conversation_.settle();  // without this there are no data: again in a while
      conversation_.begin();
      return;
    }
  } else if (step_ == Sdk1Step::kDeviceInfo) {
    if (const auto info = Sdk1DeviceInfo::parse(frame.payload)) {
      firmware_ = info->firmware;
      conversation_.tell(HostEventKind::kIdentified, out, load_be<std::uint32_t>(frame.payload, 1));
    } else {
      conversation_.count_unexpected();
    }
  } else if (step_ == Sdk1Step::kExtrinsic) {
    extrinsic_ = Sdk1Extrinsic::parse(frame.payload.subspan(1));
    if (extrinsic_) {
      conversation_.tell_extrinsic(*extrinsic_, out);
    } else {
      conversation_.count_unexpected();
    }
  }
  begin_step(after(step_), now, out);
}

void Sdk1Host::advance(Stamp now, HostOutput& out) {
  if (is_connected()) {
    if (conversation_.is_silent(now)) {
      conversation_.tell(disowned_ ? HostEventKind::kHeldByOther : HostEventKind::kLost, out);
      search();
      return;
    }
    if (now >= next_heartbeat_) {
      heartbeat(now, out);
    }
  }
  if (state_ == Sdk1HostState::kSearching) {
    conversation_.look(now, out);
  } else if (state_ == Sdk1HostState::kHandshaking || state_ == Sdk1HostState::kConfiguring || conversation_.is_waiting()) {
    repeat_unanswered(now, out);
  }
}

void Sdk1Host::repeat_unanswered(Stamp now, HostOutput& out) {
  const Patience patience = conversation_.patience(now);
  if (patience == Patience::kWait) {
    return;
  }
  const bool again = patience == Patience::kAskAgain;
  if (state_ == Sdk1HostState::kHandshaking) {
    if (again) {
      handshake(now, out);
    } else {
      conversation_.tell(HostEventKind::kNoAnswer, out);
      search();
    }
  } else if (asked_mode_) {
    if (again) {
      ask_for_mode(now, out);
    } else {
      conversation_.settle();  // the next heartbeat begins anew
      asked_mode_ = false;
      tell_result(kNoResult, Sdk1Command::kSetMode, out);
    }
  } else if (state_ == Sdk1HostState::kConfiguring) {
    if (again) {
      send_step(now, out);
      return;
    }
    tell_result(kNoResult, command_of(step_), out);
    begin_step(step_ == Sdk1Step::kStart ? step_ : after(step_), now, out);
  }
}

void Sdk1Host::stop(HostOutput& out) {
  if (is_connected()) {
    send(Sdk1Command::kSampling, one_byte(0).view(), out);
    send(Sdk1Command::kDisconnect, {}, out);
    conversation_.tell(HostEventKind::kStopped, out);
  }
  search();
  state_ = Sdk1HostState::kStopped;
}

void Sdk1Host::start() {
  if (state_ == Sdk1HostState::kStopped) {
    search();
  }
}

void Sdk1Host::set_again(Stamp now, HostOutput& out) {
  if (is_sampling()) {
    conversation_.tell(HostEventKind::kNoData, out);
    begin_step(Sdk1Step::kDeviceInfo, now, out);
  }
}

void Sdk1Host::set_mode(Sdk1Mode mode, Stamp now, HostOutput& out) {
  mode_ = mode;
  if (is_connected() && work_) {
    conversation_.be_due_at(now);
    note_state(*work_, now, out);
  }
}

bool Sdk1Host::set_utc(const Sdk1Utc& utc, HostOutput& out) {
  if (!is_connected()) {
    return false;
  }
  send(Sdk1Command::kSetUtc, utc.bytes().view(), out);
  return true;
}

void Sdk1Host::search() {
  state_ = Sdk1HostState::kSearching;
  conversation_.search();
  asked_mode_ = false;
}

std::uint32_t Sdk1Host::send(Sdk1Command command, std::span<const std::byte> payload, HostOutput& out) {
  const std::uint32_t number = conversation_.next_number();
  Conversation::send(
      write_sdk1_frame({Sdk1FrameType::kCommand, static_cast<std::uint16_t>(number), command, payload}),
      config_.command_port, device(), out);
  return number;
}

}  // namespace slamd::livox
