#include "drivers/livox/sdk2_host.hpp"

#include "core/base/bytes.hpp"

namespace slamd::livox {

namespace {

constexpr std::uint8_t kWorkSampling = 1;
constexpr std::uint8_t kWorkIdle = 2;
constexpr std::uint8_t kWorkReady = 9;
constexpr std::uint8_t kAfterReboot = 0x21;  // accepted
constexpr std::uint16_t kStateDevicePort = 56200;
constexpr std::uint16_t kPointDevicePort = 56300;
constexpr std::uint16_t kImuDevicePort = 56400;

constexpr Sdk2Key kReadKeys[] = {Sdk2Key::kFirmware,  Sdk2Key::kAttitude,  Sdk2Key::kPointDestination,
                                 Sdk2Key::kWorkState, Sdk2Key::kPowerUps};
/// A restart explains whatever else has changed: it comes first.
constexpr Sdk2Key kStateKeys[] = {Sdk2Key::kPowerUps, Sdk2Key::kWorkState,   Sdk2Key::kPointDestination,
                                  Sdk2Key::kSyncType, Sdk2Key::kTemperature, Sdk2Key::kHealth};

/// Indexed by Step.
constexpr const char* kStepWords[] = {"send its data here",           "set the type of the points",
                                      "set the scan pattern",         "switch the inertial sensor",
                                      "send points",                  "change the work mode"};

}  // namespace

std::string_view name_of(Sdk2HostState state) {
  switch (state) {
    case Sdk2HostState::kSearching:
      return "searching";
    case Sdk2HostState::kReading:
      return "reading";
    case Sdk2HostState::kConfiguring:
      return "configuring";
    case Sdk2HostState::kWaiting:
      return "waiting";
    case Sdk2HostState::kSampling:
      return "sampling";
    case Sdk2HostState::kResting:
      return "resting";
    case Sdk2HostState::kHeld:
      return "held";
    case Sdk2HostState::kStopped:
      return "stopped";
  }
  return "?";
}

bool Sdk2Host::connected() const {
  return state_ != Sdk2HostState::kSearching && state_ != Sdk2HostState::kStopped;
}

void Sdk2Host::receive(std::span<const std::byte> datagram, Endpoint from, Stamp now, HostOutput& out) {
  do {
    Sdk2Frame frame;
    std::size_t size = 0;
    const FrameResult result = parse_sdk2_frame(datagram, frame, size);
    ++counters_.frames[static_cast<std::size_t>(result)];
    if (result != FrameResult::kOk) {
      return;
    }
    take_frame(frame, from, now, out);
    datagram = datagram.subspan(size);
  } while (!datagram.empty());
}

void Sdk2Host::take_frame(const Sdk2Frame& frame, Endpoint from, Stamp now, HostOutput& out) {
  if (state_ == Sdk2HostState::kStopped) {
    return;
  }
  if (!frame.from_device) {
    ++counters_.strangers;  // another host's discovery, or this one's own
    return;
  }
  if (frame.command == Sdk2Command::kDiscovery && frame.ack) {
    take_discovery(frame, from, now, out);
    return;
  }
  if (!connected() || from.address != device_.address) {
    ++counters_.strangers;
    return;
  }
  heard_ = now;
  if (frame.command == Sdk2Command::kStatePush && !frame.ack) {
    take_values(Sdk2ValueReader::of_push(frame.payload), now, out);
  } else if (frame.ack) {
    take_answer(frame, now, out);
  } else {
    ++counters_.unexpected;
  }
}

void Sdk2Host::take_discovery(const Sdk2Frame& frame, Endpoint from, Stamp now, HostOutput& out) {
  const std::optional<Sdk2Discovery> found = Sdk2Discovery::parse(frame.payload);
  if (!found || found->result != 0) {
    ++counters_.unexpected;
    return;
  }
  if (state_ != Sdk2HostState::kSearching) {
    return;  // another host's search is answered to everybody
  }
  if (config_.serial_number != DeviceCode{} && found->serial_number != config_.serial_number) {
    ++counters_.strangers;
    return;
  }
  serial_number_ = found->serial_number;
  device_ = {from.address, found->command_port};
  if ((from.address & config_.netmask) != (config_.host_address & config_.netmask)) {
    if (told_wrong_subnet_ != serial_number_) {
      told_wrong_subnet_ = serial_number_;
      tell(HostEventKind::kWrongSubnet, out);
    }
    return;
  }
  told_wrong_subnet_.reset();
  tell(HostEventKind::kFound, out);
  heard_ = now;
  work_.reset();
  sync_.reset();
  power_ups_.reset();
  firmware_.reset();
  health_ = 0;
  state_ = Sdk2HostState::kReading;
  tries_ = 0;
  read(now, out);
}

void Sdk2Host::read(Stamp now, HostOutput& out) {
  state_ = Sdk2HostState::kReading;
  other_host_ = 0;
  asked_ = send(Sdk2Command::kGetParameters, sdk2_question(kReadKeys).view(), device_, out);
  ++tries_;
  ask_again_ = now + kAnswerWait;
  next_ask_ = now + kAskEvery;
}

void Sdk2Host::ask(Stamp now, HostOutput& out) {
  state_asked_ = send(Sdk2Command::kGetParameters, sdk2_question(kStateKeys).view(), device_, out);
  next_ask_ = now + kAskEvery;
}

void Sdk2Host::take_answer(const Sdk2Frame& frame, Stamp now, HostOutput& out) {
  const std::optional<std::uint8_t> result = result_of(frame.payload);
  if (frame.command == Sdk2Command::kGpsTime && result) {
    if (*result == 0) {
      tell(HostEventKind::kTimeSet, out);
    } else {
      tell(HostEventKind::kCommandFailed, out, *result, "take the time");
    }
  } else if (frame.command == Sdk2Command::kGetParameters && frame.sequence == state_asked_ && state_asked_ != 0) {
    state_asked_ = 0;
    take_values(Sdk2ValueReader::of_answer(frame.payload), now, out);
  } else if (asked_ == 0 || frame.sequence != asked_ || !result) {
    ++counters_.unexpected;  // late, or somebody else's
  } else if (state_ == Sdk2HostState::kReading && frame.command == Sdk2Command::kGetParameters) {
    asked_ = 0;
    take_values(Sdk2ValueReader::of_answer(frame.payload), now, out);
    if (state_ != Sdk2HostState::kReading) {
      return;
    }
    if (other_host_ != 0 && !config_.take_over) {
      state_ = Sdk2HostState::kHeld;
      tell(HostEventKind::kHeldByOther, out, other_host_);
      return;
    }
    if (other_host_ != 0) {
      tell(HostEventKind::kTakenOver, out, other_host_);
    }
    tell(HostEventKind::kConnected, out);
    begin_step(Step::kDestinations, now, out);
  } else if (state_ == Sdk2HostState::kConfiguring && frame.command == Sdk2Command::kSetParameters) {
    take_set_ack(frame, now, out);
  } else {
    ++counters_.unexpected;
  }
}

void Sdk2Host::take_set_ack(const Sdk2Frame& frame, Stamp now, HostOutput& out) {
  asked_ = 0;
  const std::uint8_t result = *result_of(frame.payload);
  if (result != 0) {
    tell(HostEventKind::kCommandFailed, out, result, kStepWords[static_cast<std::size_t>(step_)]);
  }
  const bool needed = step_ == Step::kDestinations || step_ == Step::kWorkMode;
  if (result != 0 && result != kAfterReboot && needed) {
    tries_ = 0;  // without this there are no data: again in a while
    return;
  }
  begin_step(static_cast<Step>(static_cast<int>(step_) + 1), now, out);
}

void Sdk2Host::take_values(Sdk2ValueReader values, Stamp now, HostOutput& out) {
  Sdk2Value value;
  while (values.next(value)) {
    take_value(value, now, out);
  }
  counters_.unexpected += values.complete() ? 0 : 1;
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
        tell(HostEventKind::kSyncChanged, out, *sync);
      }
      break;
    case Sdk2Key::kFirmware:
      if (value.bytes.size() == 4 && firmware_ != load_be<std::uint32_t>(value.bytes, 0)) {
        firmware_ = load_be<std::uint32_t>(value.bytes, 0);
        tell(HostEventKind::kIdentified, out, *firmware_);
      }
      break;
    case Sdk2Key::kAttitude:
      if (const auto attitude = Sdk1Extrinsic::parse(value.bytes)) {
        attitude_ = attitude;
        tell(HostEventKind::kExtrinsicRead, out);
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
    tell(HostEventKind::kStateChanged, out, work);
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
      tell(HostEventKind::kSampling, out);
    }
    state_ = wanted;
    return;
  }
  state_ = Sdk2HostState::kWaiting;
  // In between (self test, motor) there is nothing to do but to wait.
  if ((idle || *work_ == kWorkSampling) && now >= ask_again_) {
    begin_step(Step::kWorkMode, now, out);
  }
}

void Sdk2Host::note_destination(const Sdk2Destination& destination, Stamp now, HostOutput& out) {
  const bool elsewhere = destination.host_address != config_.host_address;
  switch (state_) {
    case Sdk2HostState::kReading:
      other_host_ = elsewhere ? destination.host_address : 0;
      break;
    case Sdk2HostState::kSampling:
    case Sdk2HostState::kWaiting:
    case Sdk2HostState::kResting:
      // It was set to send here: somebody else has set it since. Two hosts that take it from each other help nobody.
      if (elsewhere) {
        asked_ = 0;
        state_ = Sdk2HostState::kHeld;
        tell(HostEventKind::kHeldByOther, out, destination.host_address);
      }
      break;
    case Sdk2HostState::kHeld:
      if (!elsewhere || destination.host_address == 0) {
        tries_ = 0;
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
    tell(HostEventKind::kRestarted, out);
    tries_ = 0;
    read(now, out);
  }
}

void Sdk2Host::note_health(std::span<const std::byte> codes, HostOutput& out) {
  std::uint32_t first = 0;
  for (std::size_t at = 0; at + 4 <= codes.size() && first == 0; at += 4) {
    first = load_le<std::uint32_t>(codes, at);
  }
  if (health_ != first) {
    health_ = first;
    tell(HostEventKind::kHealthChanged, out, first);
  }
}

void Sdk2Host::begin_step(Step step, Stamp now, HostOutput& out) {
  state_ = Sdk2HostState::kConfiguring;
  step_ = step == Step::kScanPattern && !config_.scan_pattern ? Step::kImu : step;
  if (step_ == Step::kDone) {
    asked_ = 0;
    state_ = Sdk2HostState::kWaiting;
    ask_again_ = now + kAnswerWait;
    ask(now, out);  // the answer tells whether it has begun
    return;
  }
  tries_ = 0;
  send_step(now, out);
}

void Sdk2Host::send_step(Stamp now, HostOutput& out) {
  Sdk2ValueWriter values;
  const std::uint32_t here = config_.host_address;
  switch (step_) {
    case Step::kDestinations:
      values.add(Sdk2Key::kStateDestination,
                 Sdk2Destination{here, config_.state_port, kStateDevicePort}.bytes().view());
      values.add(Sdk2Key::kPointDestination,
                 Sdk2Destination{here, config_.point_port, kPointDevicePort}.bytes().view());
      values.add(Sdk2Key::kImuDestination, Sdk2Destination{here, config_.imu_port, kImuDevicePort}.bytes().view());
      break;
    case Step::kPointType:
      values.add(Sdk2Key::kPointType, config_.point_type);
      break;
    case Step::kScanPattern:
      values.add(Sdk2Key::kScanPattern, *config_.scan_pattern);
      break;
    case Step::kImu:
      values.add(Sdk2Key::kImuEnable, std::uint8_t{config_.imu});
      break;
    case Step::kPointSend:
      values.add(Sdk2Key::kPointSend, std::uint8_t{0});
      break;
    case Step::kWorkMode:
      values.add(Sdk2Key::kWorkMode, work_mode());
      break;
    case Step::kDone:
      break;
  }
  asked_ = send(Sdk2Command::kSetParameters, values.payload(), device_, out);
  ++tries_;
  ask_again_ = now + kAnswerWait;
}

void Sdk2Host::advance(Stamp now, HostOutput& out) {
  if (state_ == Sdk2HostState::kStopped) {
    return;
  }
  if (state_ == Sdk2HostState::kSearching) {
    discover(now, out);
    return;
  }
  if (now - heard_ > kLostAfter) {
    tell(HostEventKind::kLost, out);
    search();
    return;
  }
  if (now >= next_ask_ && state_ != Sdk2HostState::kReading) {
    ask(now, out);
  }
  repeat_unanswered(now, out);
}

void Sdk2Host::discover(Stamp now, HostOutput& out) {
  if (!searching_since_) {
    searching_since_ = now;
  } else if (now - *searching_since_ > kNotSeenAfter && !told_not_seen_) {
    told_not_seen_ = true;
    out.events.try_push_back({HostEventKind::kNotSeen, config_.serial_number, 0, 0, ""});
  }
  if (now >= next_discovery_) {
    next_discovery_ = now + kDiscoverEvery;
    send(Sdk2Command::kDiscovery, {}, {kEverybody, kDiscoveryPort}, out);
  }
}

void Sdk2Host::repeat_unanswered(Stamp now, HostOutput& out) {
  const bool asking = state_ == Sdk2HostState::kReading || state_ == Sdk2HostState::kConfiguring;
  if (!asking || now < ask_again_) {
    return;
  }
  if (tries_ < kTries) {
    if (state_ == Sdk2HostState::kReading) {
      read(now, out);
    } else {
      send_step(now, out);
    }
    return;
  }
  if (state_ == Sdk2HostState::kReading) {
    tell(HostEventKind::kNoAnswer, out);
    search();
    return;
  }
  tell(HostEventKind::kCommandFailed, out, kNoResult, kStepWords[static_cast<std::size_t>(step_)]);
  if (step_ == Step::kDestinations || step_ == Step::kWorkMode) {
    tries_ = 0;
    send_step(now, out);
  } else {
    begin_step(static_cast<Step>(static_cast<int>(step_) + 1), now, out);
  }
}

void Sdk2Host::stop(HostOutput& out) {
  if (connected() && state_ != Sdk2HostState::kHeld) {
    Sdk2ValueWriter values;
    values.add(Sdk2Key::kWorkMode, kWorkIdle);
    send(Sdk2Command::kSetParameters, values.payload(), device_, out);
    tell(HostEventKind::kStopped, out);
  }
  search();
  state_ = Sdk2HostState::kStopped;
}

void Sdk2Host::start() {
  if (state_ == Sdk2HostState::kStopped) {
    search();
  }
}

void Sdk2Host::set_sampling(bool sampling, Stamp now, HostOutput& out) {
  sampling_ = sampling;
  ask_again_ = state_ == Sdk2HostState::kConfiguring || state_ == Sdk2HostState::kReading ? ask_again_ : now;
  settle(now, out);
}

bool Sdk2Host::set_gps_time(std::uint64_t utc_ns, HostOutput& out) {
  if (!connected()) {
    return false;
  }
  send(Sdk2Command::kGpsTime, Sdk2GpsTime{utc_ns}.bytes().view(), device_, out);
  return true;
}

void Sdk2Host::search() {
  state_ = Sdk2HostState::kSearching;
  searching_since_.reset();
  told_not_seen_ = false;
  asked_ = 0;
  state_asked_ = 0;
}

std::uint32_t Sdk2Host::send(Sdk2Command command,
                             std::span<const std::byte> payload,
                             Endpoint to,
                             HostOutput& out) {
  last_sequence_ += last_sequence_ == 0xFFFFFFFF ? 2 : 1;  // never 0
  HostOutput::Datagram datagram;
  datagram.to = to;
  datagram.bytes = write_sdk2_frame({last_sequence_, command, false, false, payload});
  out.datagrams.try_push_back(datagram);
  return last_sequence_;
}

void Sdk2Host::tell(HostEventKind kind, HostOutput& out, std::uint32_t value, const char* command) const {
  out.events.try_push_back({kind, serial_number_, device_.address, value, command});
}

}  // namespace slamd::livox
