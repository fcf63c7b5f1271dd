#include "drivers/livox/sdk1_host.hpp"

#include "core/base/bytes.hpp"

namespace slamd::livox {

namespace {

constexpr std::uint8_t kSwitching = 2;  // the answer to a mode that takes a while

const char* words_of(Sdk1Command command) {
  switch (command) {
    case Sdk1Command::kDeviceInfo:
      return "tell the firmware";
    case Sdk1Command::kCoordinate:
      return "set the coordinates";
    case Sdk1Command::kSetReturnMode:
      return "set the return mode";
    case Sdk1Command::kSetImuRate:
      return "set the inertial sensor's rate";
    case Sdk1Command::kGetExtrinsic:
      return "tell the extrinsic";
    case Sdk1Command::kSampling:
      return "start sampling";
    case Sdk1Command::kSetMode:
      return "change the mode";
    case Sdk1Command::kSetUtc:
      return "take the time";
    default:
      return "do what it was told";
  }
}

Sdk1WorkState work_state_of(Sdk1Mode mode) { return static_cast<Sdk1WorkState>(mode); }

}  // namespace

std::string_view name_of(Sdk1HostState state) {
  switch (state) {
    case Sdk1HostState::kSearching:
      return "searching";
    case Sdk1HostState::kHandshaking:
      return "handshaking";
    case Sdk1HostState::kWaiting:
      return "waiting";
    case Sdk1HostState::kConfiguring:
      return "configuring";
    case Sdk1HostState::kSampling:
      return "sampling";
    case Sdk1HostState::kResting:
      return "resting";
    case Sdk1HostState::kStopped:
      return "stopped";
  }
  return "?";
}

bool Sdk1Host::connected() const {
  return state_ != Sdk1HostState::kSearching && state_ != Sdk1HostState::kHandshaking &&
         state_ != Sdk1HostState::kStopped;
}

void Sdk1Host::receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out) {
  // Real devices put several answers into one datagram.
  do {
    Sdk1Frame frame;
    std::size_t size = 0;
    const FrameResult result = parse_sdk1_frame(datagram, frame, size);
    ++counters_.frames[static_cast<std::size_t>(result)];
    if (result != FrameResult::kOk) {
      return;
    }
    take_frame(frame, from, now, out);
    datagram = datagram.subspan(size);
  } while (!datagram.empty());
}

void Sdk1Host::take_frame(const Sdk1Frame& frame, Endpoint from, Stamp now, HostOutput& out) {
  if (state_ == Sdk1HostState::kStopped) {
    return;
  }
  if (frame.command == Sdk1Command::kBroadcast && frame.type == Sdk1FrameType::kMessage) {
    take_broadcast(frame, from, now, out);
    return;
  }
  if (state_ == Sdk1HostState::kSearching || from.address != device_.address) {
    ++counters_.strangers;
    return;
  }
  if (frame.command == Sdk1Command::kAbnormalStatus && frame.type == Sdk1FrameType::kMessage && connected()) {
    if (frame.payload.size() == 4) {
      note_status(load_le<std::uint32_t>(frame.payload, 0), out);
    } else {
      ++counters_.unexpected;
    }
    return;
  }
  if (frame.type != Sdk1FrameType::kAck) {
    ++counters_.unexpected;
    return;
  }
  if (frame.command == Sdk1Command::kHeartbeat && connected()) {
    take_heartbeat_ack(frame, now, out);
  } else if (frame.command == Sdk1Command::kSetUtc && connected()) {
    const std::uint8_t result = result_of(frame.payload).value_or(1);
    if (result == 0) {
      tell(HostEventKind::kTimeSet, out);
    } else {
      tell(HostEventKind::kCommandFailed, out, result, words_of(Sdk1Command::kSetUtc));
    }
  } else if (asked_ == 0 || frame.sequence != asked_ || frame.payload.empty()) {
    ++counters_.unexpected;  // late, or somebody else's
  } else if (state_ == Sdk1HostState::kHandshaking) {
    take_handshake_ack(frame, now, out);
  } else if (asked_mode_) {
    take_mode_ack(frame, now, out);
  } else {
    take_step_ack(frame, now, out);
  }
}

void Sdk1Host::take_broadcast(const Sdk1Frame& frame, Endpoint from, Stamp now, HostOutput& out) {
  const std::optional<Sdk1Broadcast> broadcast = Sdk1Broadcast::parse(frame.payload);
  if (!broadcast) {
    ++counters_.unexpected;
    return;
  }
  const bool any = config_.device == DeviceCode{};
  if (!any && broadcast->code != config_.device) {
    ++counters_.strangers;
    return;
  }
  if (connected()) {
    if (broadcast->code != code_) {
      ++counters_.strangers;
      return;
    }
    if (now - connected_since_ < kStaleBroadcast) {
      return;
    }
    tell(HostEventKind::kRestarted, out);  // a device that has a host does not look for one
    search();
  }
  if (state_ == Sdk1HostState::kHandshaking) {
    return;  // the answer is on its way, or asked for again in time
  }
  device_ = from;
  code_ = broadcast->code;
  if ((from.address & config_.netmask) != (config_.host_address & config_.netmask)) {
    if (told_wrong_subnet_ != code_) {
      told_wrong_subnet_ = code_;
      tell(HostEventKind::kWrongSubnet, out);
    }
    return;
  }
  told_wrong_subnet_.reset();
  if (!told_held_) {
    tell(HostEventKind::kFound, out);
  }
  state_ = Sdk1HostState::kHandshaking;
  tries_ = 0;
  handshake(now, out);
}

void Sdk1Host::handshake(Stamp now, HostOutput& out) {
  Sdk1Handshake message;
  message.host_address = config_.host_address;
  message.data_port = config_.data_port;
  message.command_port = config_.command_port;
  message.imu_port = config_.imu_port;
  asked_ = send(Sdk1Command::kHandshake, message.bytes().view(), out);
  ++tries_;
  ask_again_ = now + kAnswerWait;
}

void Sdk1Host::take_handshake_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out) {
  if (frame.command != Sdk1Command::kHandshake) {
    ++counters_.unexpected;
    return;
  }
  asked_ = 0;
  if (*result_of(frame.payload) != 0) {
    if (!told_held_) {
      told_held_ = true;
      tell(HostEventKind::kHeldByOther, out);
    }
    search();  // its next broadcast is the next try
    return;
  }
  told_held_ = false;
  told_not_seen_ = false;
  disowned_ = false;
  state_ = Sdk1HostState::kWaiting;
  connected_since_ = now;
  heard_ = now;
  ask_again_ = now;
  work_.reset();
  progress_.reset();
  status_.reset();
  tell(HostEventKind::kConnected, out);
  heartbeat(now, out);
}

void Sdk1Host::heartbeat(Stamp now, HostOutput& out) {
  send(Sdk1Command::kHeartbeat, {}, out);
  next_heartbeat_ = now + kHeartbeatEvery;
}

void Sdk1Host::take_heartbeat_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out) {
  const std::optional<Sdk1HeartbeatAck> ack = Sdk1HeartbeatAck::parse(frame.payload);
  if (!ack) {
    ++counters_.unexpected;
    return;
  }
  if (ack->result != 0) {
    disowned_ = true;  // three seconds of that are a loss
    return;
  }
  disowned_ = false;
  heard_ = now;
  if (ack->state == Sdk1WorkState::kInitialising) {
    if (progress_ != ack->status_or_progress) {
      progress_ = ack->status_or_progress;
      tell(HostEventKind::kInitialising, out, ack->status_or_progress);
    }
  } else {
    note_status(ack->status_or_progress, out);
  }
  note_state(ack->state, now, out);
}

void Sdk1Host::note_status(std::uint32_t code, HostOutput& out) {
  if (status_ != code) {
    status_ = code;
    tell(HostEventKind::kStatusChanged, out, code);
  }
}

void Sdk1Host::note_state(Sdk1WorkState work, Stamp now, HostOutput& out) {
  if (work_ != work) {
    work_ = work;
    tell(HostEventKind::kStateChanged, out, static_cast<std::uint32_t>(work));
  }
  const bool there = work == work_state_of(mode_);
  if (there && mode_ == Sdk1Mode::kNormal) {
    if (state_ == Sdk1HostState::kWaiting || state_ == Sdk1HostState::kResting) {
      asked_ = 0;
      begin_step(Step::kDeviceInfo, now, out);
    }
    return;
  }
  if (there) {
    asked_ = 0;
    state_ = Sdk1HostState::kResting;
    return;
  }
  if (state_ != Sdk1HostState::kWaiting) {
    asked_ = 0;
    state_ = Sdk1HostState::kWaiting;
  }
  const bool may_switch = work == Sdk1WorkState::kNormal || work == Sdk1WorkState::kPowerSaving ||
                          work == Sdk1WorkState::kStandby;
  if (may_switch && asked_ == 0 && now >= ask_again_) {  // not again with each answer
    ask_for_mode(now, out);
  }
}

void Sdk1Host::ask_for_mode(Stamp now, HostOutput& out) {
  asked_ = send(Sdk1Command::kSetMode, one_byte(static_cast<std::uint8_t>(mode_)).view(), out);
  asked_mode_ = true;
  tries_ = 1;
  ask_again_ = now + kAnswerWait;
}

void Sdk1Host::take_mode_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out) {
  if (frame.command != Sdk1Command::kSetMode) {
    ++counters_.unexpected;
    return;
  }
  asked_ = 0;
  asked_mode_ = false;
  const std::uint8_t result = *result_of(frame.payload);
  if (result != 0 && result != kSwitching) {
    tell(HostEventKind::kCommandFailed, out, result, words_of(Sdk1Command::kSetMode));
  }
  heartbeat(now, out);  // its answer tells the new state
}

void Sdk1Host::begin_step(Step step, Stamp now, HostOutput& out) {
  state_ = Sdk1HostState::kConfiguring;
  asked_mode_ = false;
  step_ = step;
  while (step_ != Step::kDone && !wanted(step_)) {
    step_ = static_cast<Step>(static_cast<int>(step_) + 1);
  }
  if (step_ == Step::kDone) {
    asked_ = 0;
    state_ = Sdk1HostState::kSampling;
    tell(HostEventKind::kSampling, out);
    return;
  }
  tries_ = 0;
  send_step(now, out);
}

bool Sdk1Host::wanted(Step step) const {
  switch (step) {
    case Step::kReturnMode:
      return config_.return_mode.has_value();
    case Step::kExtrinsic:
      return config_.read_extrinsic;
    default:
      return true;
  }
}

void Sdk1Host::send_step(Stamp now, HostOutput& out) {
  switch (step_) {
    case Step::kDeviceInfo:
      asked_ = send(Sdk1Command::kDeviceInfo, {}, out);
      break;
    case Step::kCoordinate:
      asked_ = send(Sdk1Command::kCoordinate, one_byte(config_.coordinate).view(), out);
      break;
    case Step::kReturnMode:
      asked_ = send(Sdk1Command::kSetReturnMode, one_byte(*config_.return_mode).view(), out);
      break;
    case Step::kImuRate:
      asked_ = send(Sdk1Command::kSetImuRate, one_byte(config_.imu ? 1 : 0).view(), out);
      break;
    case Step::kExtrinsic:
      asked_ = send(Sdk1Command::kGetExtrinsic, {}, out);
      break;
    case Step::kStart:
      asked_ = send(Sdk1Command::kSampling, one_byte(1).view(), out);
      break;
    case Step::kDone:
      break;
  }
  ++tries_;
  ask_again_ = now + kAnswerWait;
}

namespace {

/// Indexed by Step.
constexpr Sdk1Command kStepCommands[] = {Sdk1Command::kDeviceInfo,    Sdk1Command::kCoordinate,
                                         Sdk1Command::kSetReturnMode, Sdk1Command::kSetImuRate,
                                         Sdk1Command::kGetExtrinsic,  Sdk1Command::kSampling};

}  // namespace

void Sdk1Host::take_step_ack(const Sdk1Frame& frame, Stamp now, HostOutput& out) {
  if (state_ != Sdk1HostState::kConfiguring || frame.command != kStepCommands[static_cast<std::size_t>(step_)]) {
    ++counters_.unexpected;
    return;
  }
  const std::uint8_t result = *result_of(frame.payload);
  if (result != 0) {
    tell(HostEventKind::kCommandFailed, out, result, words_of(frame.command));
    if (step_ == Step::kStart) {
      asked_ = 0;  // without this there are no data: again in a while
      tries_ = 0;
      return;
    }
  } else if (step_ == Step::kDeviceInfo) {
    if (const auto info = Sdk1DeviceInfo::parse(frame.payload)) {
      firmware_ = info->firmware;
      tell(HostEventKind::kIdentified, out, load_be<std::uint32_t>(frame.payload, 1));
    } else {
      ++counters_.unexpected;
    }
  } else if (step_ == Step::kExtrinsic) {
    extrinsic_ = Sdk1Extrinsic::parse(frame.payload.subspan(1));
    if (extrinsic_) {
      tell(HostEventKind::kExtrinsicRead, out);
    }
  }
  next_step(now, out);
}

void Sdk1Host::next_step(Stamp now, HostOutput& out) {
  begin_step(static_cast<Step>(static_cast<int>(step_) + 1), now, out);
}

void Sdk1Host::advance(Stamp now, HostOutput& out) {
  if (connected()) {
    if (now - heard_ > kLostAfter) {
      tell(disowned_ ? HostEventKind::kHeldByOther : HostEventKind::kLost, out);
      search();
      return;
    }
    if (now >= next_heartbeat_) {
      heartbeat(now, out);
    }
  }
  if (state_ == Sdk1HostState::kSearching) {
    if (!searching_since_) {
      searching_since_ = now;
    } else if (now - *searching_since_ > kNotSeenAfter && !told_not_seen_) {
      told_not_seen_ = true;
      out.events.try_push_back({HostEventKind::kNotSeen, config_.device, 0, 0, ""});
    }
  } else if (state_ == Sdk1HostState::kHandshaking || state_ == Sdk1HostState::kConfiguring || asked_ != 0) {
    repeat_unanswered(now, out);
  }
}

void Sdk1Host::repeat_unanswered(Stamp now, HostOutput& out) {
  if (now < ask_again_) {
    return;
  }
  if (state_ == Sdk1HostState::kHandshaking) {
    if (tries_ < kTries) {
      handshake(now, out);
    } else {
      tell(HostEventKind::kNoAnswer, out);
      search();
    }
  } else if (asked_mode_) {
    if (tries_ < kTries) {
      const int tries = tries_ + 1;
      ask_for_mode(now, out);
      tries_ = tries;
    } else {
      asked_ = 0;  // the next heartbeat begins anew
      asked_mode_ = false;
      tell(HostEventKind::kCommandFailed, out, kNoResult, words_of(Sdk1Command::kSetMode));
    }
  } else if (state_ == Sdk1HostState::kConfiguring) {
    if (tries_ < kTries) {
      send_step(now, out);
      return;
    }
    tell(HostEventKind::kCommandFailed, out, kNoResult, words_of(kStepCommands[static_cast<std::size_t>(step_)]));
    if (step_ == Step::kStart) {
      tries_ = 0;
      send_step(now, out);
    } else {
      next_step(now, out);
    }
  }
}

void Sdk1Host::stop(Stamp /*now*/, HostOutput& out) {
  if (connected()) {
    send(Sdk1Command::kSampling, one_byte(0).view(), out);
    send(Sdk1Command::kDisconnect, {}, out);
    tell(HostEventKind::kStopped, out);
  }
  search();
  state_ = Sdk1HostState::kStopped;
}

void Sdk1Host::start() {
  if (state_ == Sdk1HostState::kStopped) {
    search();
  }
}

void Sdk1Host::set_mode(Sdk1Mode mode, Stamp now, HostOutput& out) {
  mode_ = mode;
  if (connected() && work_) {
    ask_again_ = now;
    note_state(*work_, now, out);
  }
}

bool Sdk1Host::set_utc(const Sdk1Utc& utc, HostOutput& out) {
  if (!connected()) {
    return false;
  }
  send(Sdk1Command::kSetUtc, utc.bytes().view(), out);
  return true;
}

void Sdk1Host::search() {
  state_ = Sdk1HostState::kSearching;
  searching_since_.reset();
  asked_ = 0;
  asked_mode_ = false;
}

std::uint16_t Sdk1Host::send(Sdk1Command command, std::span<const std::byte> payload, HostOutput& out) {
  last_sequence_ = last_sequence_ == 0xFFFF ? std::uint16_t{1} : static_cast<std::uint16_t>(last_sequence_ + 1);
  HostOutput::Datagram datagram;
  datagram.to = device_;
  datagram.bytes = write_sdk1_frame({Sdk1FrameType::kCommand, last_sequence_, command, payload});
  out.datagrams.try_push_back(datagram);
  return last_sequence_;
}

void Sdk1Host::tell(HostEventKind kind, HostOutput& out, std::uint32_t value, const char* command) const {
  out.events.try_push_back({kind, code_, device_.address, value, command});
}

}  // namespace slamd::livox
