#include "drivers/livox/sdk2_host.hpp"

#include "core/base/bytes.hpp"

namespace slamd::livox {

namespace {

constexpr std::uint8_t kWorkSampling = 1;
constexpr std::uint8_t kWorkIdle = 2;
constexpr std::uint8_t kWorkReady = 9;
constexpr std::uint8_t kAfterReboot = 0x21;  // accepted

/// Indexed by Sdk2HostState.
constexpr std::string_view kStateNames[] = {"searching", "reading", "configuring", "waiting", "sampling",
                                            "resting",   "held", "stopped"};

}  // namespace

std::string_view name_of(Sdk2HostState state) { return kStateNames[static_cast<std::size_t>(state)]; }

Sdk2Host::Sdk2Host(const Sdk2HostConfig& config)
    : config_(config),
      conversation_({config.serial_number, config.interfaces, 0xFFFFFFFF, kAnswerWait, kLostAfter}) {}

std::string_view Sdk2Host::state_name() const { return name_of(state_); }

bool Sdk2Host::is_connected() const {
  return state_ != Sdk2HostState::kSearching && state_ != Sdk2HostState::kStopped;
}

void Sdk2Host::receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out) {
  conversation_.read<Sdk2Frame>(datagram, parse_sdk2_frame,
                                [&](const Sdk2Frame& frame) { take_frame(frame, from, now, out); });
}

void Sdk2Host::take_frame(const Sdk2Frame& frame, Endpoint from, Stamp now, HostOutput& out) {
  if (state_ == Sdk2HostState::kStopped) {
    return;
  }
  if (!frame.from_device) {
    conversation_.count_stranger();  // another host's discovery, or this one's own
    return;
  }
  if (frame.command == Sdk2Command::kDiscovery && frame.ack) {
    take_discovery(frame, from, now, out);
    return;
  }
  if (!is_connected() || !conversation_.is_with(from)) {
    conversation_.count_stranger();
    return;
  }
  conversation_.hear(now);
  if (frame.command == Sdk2Command::kStatePush && !frame.ack) {
    take_values(Sdk2ValueReader::of_push(frame.payload), now, out);
  } else if (frame.ack) {
    take_answer(frame, now, out);
  } else {
    conversation_.count_unexpected();
  }
}

void Sdk2Host::take_discovery(const Sdk2Frame& frame, Endpoint from, Stamp now, HostOutput& out) {
  const std::optional<Sdk2Discovery> found = Sdk2Discovery::parse(frame.payload);
  if (!found || found->result != 0) {
    conversation_.count_unexpected();
    return;
  }
  if (state_ != Sdk2HostState::kSearching) {
    return;  // another host's search is answered to everybody
  }
  if (!conversation_.wants(found->serial_number)) {
    conversation_.count_stranger();
    return;
  }
  if (!conversation_.meet(found->serial_number, {from.address, found->command_port}, out)) {
    return;
  }
  conversation_.tell(HostEventKind::kFound, out);
  conversation_.hear(now);
  work_.reset();
  sync_.reset();
  power_ups_.reset();
  firmware_.reset();
  health_ = 0;
  conversation_.begin();
  read(now, out);
}

void Sdk2Host::read(Stamp now, HostOutput& out) {
  state_ = Sdk2HostState::kReading;
  other_host_ = 0;
  conversation_.expect(send(Sdk2Command::kGetParameters, sdk2_question(kSdk2ReadKeys).view(), out), now);
  next_ask_ = now + kAskEvery;
}

void Sdk2Host::ask(Stamp now, HostOutput& out) {
  state_asked_ = send(Sdk2Command::kGetParameters, sdk2_question(kSdk2StateKeys).view(), out);
  next_ask_ = now + kAskEvery;
}

void Sdk2Host::take_answer(const Sdk2Frame& frame, Stamp now, HostOutput& out) {
  const std::optional<std::uint8_t> result = result_of(frame.payload);
  if (frame.command == Sdk2Command::kGpsTime && result) {
    conversation_.tell(*result == 0 ? HostEventKind::kTimeSet : HostEventKind::kCommandFailed, out, *result, "take the time");
  } else if (frame.command == Sdk2Command::kGetParameters && frame.sequence == state_asked_ && state_asked_ != 0) {
    state_asked_ = 0;
    take_values(Sdk2ValueReader::of_answer(frame.payload), now, out);
  } else if (!conversation_.answers(frame.sequence) || !result) {
    conversation_.count_unexpected();  // late, or somebody else's
  } else if (state_ == Sdk2HostState::kReading && frame.command == Sdk2Command::kGetParameters) {
    conversation_.settle();
    take_values(Sdk2ValueReader::of_answer(frame.payload), now, out);
    if (state_ != Sdk2HostState::kReading) {
      return;
    }
    if (other_host_ != 0 && !config_.take_over) {
      state_ = Sdk2HostState::kHeld;
      conversation_.tell(HostEventKind::kHeldByOther, out, other_host_);
      return;
    }
    if (other_host_ != 0) {
      conversation_.tell(HostEventKind::kTakenOver, out, other_host_);
    }
    conversation_.tell(HostEventKind::kConnected, out);
    begin_step(Sdk2Step::kDestinations, now, out);
  } else if (state_ == Sdk2HostState::kConfiguring && frame.command == Sdk2Command::kSetParameters) {
    take_set_ack(frame, now, out);
  } else {
    conversation_.count_unexpected();
  }
}

void Sdk2Host::take_set_ack(const Sdk2Frame& frame, Stamp now, HostOutput& out) {
  conversation_.settle();
  const std::uint8_t result = *result_of(frame.payload);
  if (result != 0) {
    conversation_.tell(HostEventKind::kCommandFailed, out, result, words_of(step_));
  }
  if (result != 0 && result != kAfterReboot && is_needed(step_)) {
    conversation_.begin();  // without this there are no data: again in a while
    return;
  }
  begin_step(after(step_), now, out);
}

void Sdk2Host::take_values(Sdk2ValueReader values, Stamp now, HostOutput& out) {
  Sdk2Value value;
  while (values.next(value)) {
    take_value(value, now, out);
  }
  if (!values.complete()) {
    conversation_.count_unexpected();
  }
}

void Sdk2Host::take_value(const Sdk2Value& value, Stamp now, HostOutput& out) {
  switch (value.key) {
    case Sdk2Key::kWorkState:
      if (const auto work = value.as_u8()) {
        note_work_state(*work, now, out);
      }
      break;
    case Sdk2Key::kPointDestination:
      if (const auto destination = Sdk2Destination::parse(value.bytes)) {
        note_destination(*destination, now, out);
      }
      break;
    case Sdk2Key::kPowerUps:
      if (const auto count = value.as_u32()) {
        note_power_ups(*count, now, out);
      }
      break;
    case Sdk2Key::kSyncType:
      if (const auto sync = value.as_u8(); sync && sync_ != sync) {
        sync_ = sync;
        conversation_.tell(HostEventKind::kSyncChanged, out, *sync);
      }
      break;
    case Sdk2Key::kFirmware:
      if (value.bytes.size() == 4 && firmware_ != load_be<std::uint32_t>(value.bytes, 0)) {
        firmware_ = load_be<std::uint32_t>(value.bytes, 0);
        conversation_.tell(HostEventKind::kIdentified, out, *firmware_);
      }
      break;
    case Sdk2Key::kAttitude:
      if (const auto attitude = Sdk1Extrinsic::parse(value.bytes)) {
        attitude_ = attitude;
        conversation_.tell_extrinsic(*attitude, out);
      }
      break;
    case Sdk2Key::kTemperature:
      if (const auto raw = value.as_u32()) {
        temperature_c_ = 0.01 * static_cast<std::int32_t>(*raw);
      }
      break;
    case Sdk2Key::kHealth:
      note_health(value.bytes, out);
      break;
    default:
      break;  // of no use here
  }
}

void Sdk2Host::note_work_state(std::uint8_t work, Stamp now, HostOutput& out) {
  if (work_ != work) {
    work_ = work;
    conversation_.tell(HostEventKind::kStateChanged, out, work);
  }
  settle(now, out);
}

/// Compares the device's work state with what is wanted.
void Sdk2Host::settle(Stamp now, HostOutput& out) {
  const bool configured = state_ == Sdk2HostState::kWaiting || state_ == Sdk2HostState::kSampling ||
                          state_ == Sdk2HostState::kResting;
  if (!configured || !work_) {
    return;
  }
  const bool idle = *work_ == kWorkIdle || *work_ == kWorkReady;
  if (sampling_ ? *work_ == kWorkSampling : idle) {
    const Sdk2HostState wanted = sampling_ ? Sdk2HostState::kSampling : Sdk2HostState::kResting;
    if (state_ != wanted && sampling_) {
      conversation_.tell(HostEventKind::kSampling, out);
    }
    state_ = wanted;
    return;
  }
  state_ = Sdk2HostState::kWaiting;
  // In between (self test, motor) there is nothing to do but to wait.
  if ((idle || *work_ == kWorkSampling) && conversation_.is_due(now)) {
    begin_step(Sdk2Step::kWorkMode, now, out);
  }
}

void Sdk2Host::note_destination(const Sdk2Destination& destination, Stamp now, HostOutput& out) {
  const bool elsewhere = destination.host_address != conversation_.host_address();
  switch (state_) {
    case Sdk2HostState::kReading:
      other_host_ = elsewhere ? destination.host_address : 0;
      break;
    case Sdk2HostState::kSampling:
    case Sdk2HostState::kWaiting:
    case Sdk2HostState::kResting:
      // It was set to send here: somebody else has set it since. Two hosts that take it from each other help nobody.
      if (elsewhere) {
        conversation_.settle();
        state_ = Sdk2HostState::kHeld;
        conversation_.tell(HostEventKind::kHeldByOther, out, destination.host_address);
      }
      break;
    case Sdk2HostState::kHeld:
      if (!elsewhere || destination.host_address == 0) {
        conversation_.begin();
        read(now, out);
      }
      break;
    default:
      break;
  }
}

void Sdk2Host::note_power_ups(std::uint32_t count, Stamp now, HostOutput& out) {
  const bool restarted = power_ups_ && *power_ups_ != count;
  power_ups_ = count;
  if (restarted) {
    conversation_.tell(HostEventKind::kRestarted, out);
    conversation_.begin();
    read(now, out);
  }
}

void Sdk2Host::note_health(std::span<const std::byte> codes, HostOutput& out) {
  const std::uint32_t first = first_health_code(codes);
  if (health_ != first) {
    health_ = first;
    conversation_.tell(HostEventKind::kHealthChanged, out, first);
  }
}

void Sdk2Host::begin_step(Sdk2Step step, Stamp now, HostOutput& out) {
  state_ = Sdk2HostState::kConfiguring;
  step_ = wanted_from(step, config_);
  if (step_ == Sdk2Step::kDone) {
    conversation_.settle();
    state_ = Sdk2HostState::kWaiting;
    conversation_.be_due_at(now + kAnswerWait);
    ask(now, out);  // the answer tells whether it has begun
    return;
  }
  conversation_.begin();
  send_step(now, out);
}

void Sdk2Host::send_step(Stamp now, HostOutput& out) {
  const Sdk2ValueWriter values = values_of(step_, config_, conversation_.host_address(), work_mode());
  conversation_.expect(send(Sdk2Command::kSetParameters, values.payload(), out), now);
}

void Sdk2Host::advance(Stamp now, HostOutput& out) {
  if (!is_connected()) {
    if (state_ == Sdk2HostState::kSearching) {
      discover(now, out);
    }
    return;
  }
  if (conversation_.is_silent(now)) {
    conversation_.tell(HostEventKind::kLost, out);
    search();
    return;
  }
  if (now >= next_ask_ && state_ != Sdk2HostState::kReading) {
    ask(now, out);
  }
  repeat_unanswered(now, out);
}

void Sdk2Host::discover(Stamp now, HostOutput& out) {
  conversation_.look(now, out);
  if (now >= next_discovery_) {
    next_discovery_ = now + kDiscoverEvery;
    Conversation::send(write_sdk2_frame({conversation_.next_number(), Sdk2Command::kDiscovery, false, false, {}}),
                       kDiscoveryPort, {kEverybody, kDiscoveryPort}, out);
  }
}

void Sdk2Host::repeat_unanswered(Stamp now, HostOutput& out) {
  const bool reading = state_ == Sdk2HostState::kReading;
  if (!reading && state_ != Sdk2HostState::kConfiguring) {
    return;
  }
  const Patience patience = conversation_.patience(now);
  if (patience == Patience::kWait) {
    return;
  }
  if (patience == Patience::kAskAgain) {
    reading ? read(now, out) : send_step(now, out);
  } else if (reading) {
    conversation_.tell(HostEventKind::kNoAnswer, out);
    search();
  } else {
    conversation_.tell(HostEventKind::kCommandFailed, out, kNoResult, words_of(step_));
    begin_step(is_needed(step_) ? step_ : after(step_), now, out);
  }
}

void Sdk2Host::stop(HostOutput& out) {
  if (is_connected() && state_ != Sdk2HostState::kHeld) {
    Sdk2ValueWriter values;
    values.add(Sdk2Key::kWorkMode, kWorkIdle);
    send(Sdk2Command::kSetParameters, values.payload(), out);
    conversation_.tell(HostEventKind::kStopped, out);
  }
  search();
  state_ = Sdk2HostState::kStopped;
}

void Sdk2Host::start() {
  if (state_ == Sdk2HostState::kStopped) {
    search();
  }
}

void Sdk2Host::set_again(Stamp now, HostOutput& out) {
  if (is_sampling()) {
    conversation_.tell(HostEventKind::kNoData, out);
    conversation_.begin();
    read(now, out);
  }
}

void Sdk2Host::set_sampling(bool sampling, Stamp now, HostOutput& out) {
  sampling_ = sampling;
  if (state_ != Sdk2HostState::kConfiguring && state_ != Sdk2HostState::kReading) {
    conversation_.be_due_at(now);
  }
  settle(now, out);
}

bool Sdk2Host::set_gps_time(std::uint64_t utc_ns, HostOutput& out) {
  if (!is_connected()) {
    return false;
  }
  send(Sdk2Command::kGpsTime, Sdk2GpsTime{utc_ns}.bytes().view(), out);
  return true;
}

void Sdk2Host::search() {
  state_ = Sdk2HostState::kSearching;
  conversation_.search();
  state_asked_ = 0;
}

std::uint32_t Sdk2Host::send(Sdk2Command command, std::span<const std::byte> payload, HostOutput& out) {
  const std::uint32_t number = conversation_.next_number();
  Conversation::send(write_sdk2_frame({number, command, false, false, payload}), config_.command_port, device(), out);
  return number;
}

}  // namespace slamd::livox
