#include "tools/emulation/sdk2_device.hpp"

#include "core/base/bytes.hpp"
#include "drivers/transport/udp_receiver.hpp"

namespace slamd::emulation {

using livox::Endpoint;
using livox::FrameResult;
using livox::Sdk2Command;
using livox::Sdk2Destination;
using livox::Sdk2Frame;
using livox::Sdk2Key;
using livox::Sdk2Value;

namespace {

// livox-sdk2.md §3
constexpr std::uint8_t kNotNow = 0x02;
constexpr std::uint8_t kOutOfRange = 0x03;
constexpr std::uint8_t kUnsupported = 0x20;
constexpr std::uint8_t kReadOnly = 0x22;
constexpr std::uint8_t kBadLength = 0x23;

constexpr std::size_t kLongestAnswer = 200;

template <typename T>
std::vector<std::byte> le(T value) {
  std::vector<std::byte> bytes(sizeof value);
  store_le(std::span(bytes), 0, value);
  return bytes;
}

std::vector<std::byte> bytes_of(std::span<const std::byte> bytes) { return {bytes.begin(), bytes.end()}; }


}  // namespace

Sdk2Device::Sdk2Device(const Sdk2DeviceConfig& config, Stamp power_up) : config_(config), power_up_(power_up) {
  values_[Sdk2Key::kPointType] = le<std::uint8_t>(1);
  values_[Sdk2Key::kScanPattern] = le<std::uint8_t>(0);
  values_[Sdk2Key::kPointSend] = le<std::uint8_t>(0);
  values_[Sdk2Key::kStateDestination] = bytes_of(Sdk2Destination{}.bytes().view());
  values_[Sdk2Key::kPointDestination] = values_[Sdk2Key::kStateDestination];
  values_[Sdk2Key::kImuDestination] = values_[Sdk2Key::kStateDestination];
  values_[Sdk2Key::kAttitude] = bytes_of(config.attitude.bytes().view());
  values_[Sdk2Key::kWorkMode] = le(static_cast<std::uint8_t>(Sdk2DeviceState::kIdle));
  values_[Sdk2Key::kImuEnable] = le<std::uint8_t>(1);
  values_[Sdk2Key::kSerialNumber] = bytes_of(std::as_bytes(std::span(config.serial_number.characters)));
  values_[Sdk2Key::kFirmware] = {std::byte{13}, std::byte{18}, std::byte{0}, std::byte{17}};
  values_[Sdk2Key::kWorkState] = le(static_cast<std::uint8_t>(state_));
  values_[Sdk2Key::kTemperature] = le<std::int32_t>(4213);
  values_[Sdk2Key::kPowerUps] = le(config.power_ups);
  values_[Sdk2Key::kSyncType] = le<std::uint8_t>(0);
  values_[Sdk2Key::kHealth] = std::vector<std::byte>(32);
}

void Sdk2Device::receive(std::span<const std::byte> datagram, Endpoint from, std::uint16_t to_port, Stamp now,
                         DeviceOutput& out) {
  if (to_port != kDiscoveryPort && to_port != kCommandPort) {
    return;
  }
  while (!datagram.empty()) {
    Sdk2Frame frame;
    std::size_t size = 0;
    if (parse_sdk2_frame(datagram, frame, size) != FrameResult::kOk) {
      return;  // says nothing to what it does not understand
    }
    const bool discovery = frame.command == Sdk2Command::kDiscovery;
    if (!frame.from_device && !frame.ack && discovery == (to_port == kDiscoveryPort)) {
      take(frame, from, now, out);
    }
    datagram = datagram.subspan(size);
  }
}

void Sdk2Device::take(const Sdk2Frame& frame, Endpoint from, Stamp now, DeviceOutput& out) {
  Bytes answer;
  std::uint16_t port = kCommandPort;
  switch (frame.command) {
    case Sdk2Command::kDiscovery:
      answer = bytes_of(
          livox::Sdk2Discovery{kDone, config_.type, config_.serial_number, config_.address, kCommandPort}.bytes().view());
      port = kDiscoveryPort;
      break;
    case Sdk2Command::kSetParameters:
      answer = take_settings(frame, now, out);
      break;
    case Sdk2Command::kGetParameters:
      answer = answer_to_question(frame);
      break;
    case Sdk2Command::kGpsTime:
      gps_time_ = livox::Sdk2GpsTime::parse(frame.payload);
      answer = le(gps_time_ ? kDone : kBadLength);
      break;
    default:
      answer = le(kFailed);
      break;
  }
  out.datagrams.push_back({port, from, livox::write_sdk2_frame({frame.sequence, frame.command, true, true, answer})});
}

/// The answer has the first refusal, and its key.
Sdk2Device::Bytes Sdk2Device::take_settings(const Sdk2Frame& frame, Stamp now, DeviceOutput& out) {
  Bytes answer(3);
  livox::Sdk2ValueReader reader = livox::Sdk2ValueReader::of_push(frame.payload);
  Sdk2Value value;
  while (reader.next(value)) {
    const std::uint8_t result = set(value);
    if (result == kDone && value.key == Sdk2Key::kPointDestination) {
      const auto destination = Sdk2Destination::parse(value.bytes);
      out.news.push_back("sends its points to " + transport::dotted(destination->host_address) + ":" +
                         std::to_string(destination->host_port));
    } else if (result != kDone && answer[0] == std::byte{kDone}) {
      answer[0] = std::byte{result};
      store_le(std::span(answer), 1, static_cast<std::uint16_t>(value.key));
    }
  }
  if (!reader.complete() && answer[0] == std::byte{kDone}) {
    answer[0] = std::byte{kBadLength};
  }
  follow_work_mode(now, out);
  return answer;
}

std::uint8_t Sdk2Device::set(const Sdk2Value& value) {
  const auto known = values_.find(value.key);
  if (known == values_.end()) {
    return kUnsupported;
  }
  if (static_cast<std::uint16_t>(value.key) >= 0x8000) {
    return kReadOnly;
  }
  if (value.bytes.size() != known->second.size()) {
    return kBadLength;
  }
  if (value.key == Sdk2Key::kPointType && value.as_u8() != 1) {
    return kNotNow;
  }
  const bool is_switch = value.bytes.size() == 1 && value.key != Sdk2Key::kPointType;
  if (is_switch && *value.as_u8() > 2) {
    return kOutOfRange;
  }
  known->second = bytes_of(value.bytes);
  return kDone;
}

Sdk2Device::Bytes Sdk2Device::answer_to_question(const Sdk2Frame& frame) const {
  livox::Sdk2ValueWriter writer(kDone);
  for (std::size_t at = 4; at + 2 <= frame.payload.size(); at += 2) {
    const auto known = values_.find(static_cast<Sdk2Key>(load_le<std::uint16_t>(frame.payload, at)));
    if (known == values_.end() || writer.payload().size() + 4 + known->second.size() > kLongestAnswer) {
      return {std::byte{known == values_.end() ? kUnsupported : kFailed}, std::byte{0}, std::byte{0}};
    }
    writer.add(known->first, known->second);
  }
  return bytes_of(writer.payload());
}

void Sdk2Device::enter(Sdk2DeviceState state, Stamp now, DeviceOutput& out) {
  state_ = state;
  entered_ = now;
  values_[Sdk2Key::kWorkState] = le(static_cast<std::uint8_t>(state));
  next_push_ = now;  // a change is told at once
  out.news.push_back(state == Sdk2DeviceState::kSampling       ? "samples"
                     : state == Sdk2DeviceState::kMotorStarts ? "starts its motor"
                                                              : "is idle");
}

/// Does what the work mode says, as far as it is ready for it.
void Sdk2Device::follow_work_mode(Stamp now, DeviceOutput& out) {
  const bool wanted = setting(Sdk2Key::kWorkMode) == static_cast<std::uint8_t>(Sdk2DeviceState::kSampling);
  if (wanted && state_ == Sdk2DeviceState::kIdle) {
    enter(Sdk2DeviceState::kMotorStarts, now, out);
  } else if (!wanted && (state_ == Sdk2DeviceState::kSampling || state_ == Sdk2DeviceState::kMotorStarts)) {
    enter(Sdk2DeviceState::kIdle, now, out);
  }
}

void Sdk2Device::advance(Stamp now, DeviceOutput& out) {
  if (state_ == Sdk2DeviceState::kSelfTest && now - power_up_ >= config_.boots) {
    enter(Sdk2DeviceState::kIdle, now, out);
  }
  follow_work_mode(now, out);
  if (state_ == Sdk2DeviceState::kMotorStarts && now - entered_ >= config_.motor_starts) {
    enter(Sdk2DeviceState::kSampling, now, out);
  }
  const std::optional<Endpoint> to = endpoint(Sdk2Key::kStateDestination);
  if (to && now >= next_push_) {
    next_push_ = now + kPushEvery;
    livox::Sdk2ValueWriter values;
    for (const Sdk2Key key : {Sdk2Key::kWorkState, Sdk2Key::kTemperature}) {
      values.add(key, values_.at(key));
    }
    out.datagrams.push_back(
        {kStatePort, *to, livox::write_sdk2_frame({++pushes_, Sdk2Command::kStatePush, false, true, values.payload()})});
  }
}

std::uint8_t Sdk2Device::setting(Sdk2Key key) const { return load_le<std::uint8_t>(values_.at(key), 0); }

std::optional<Endpoint> Sdk2Device::endpoint(Sdk2Key key) const {
  const auto destination = Sdk2Destination::parse(values_.at(key));
  if (destination->host_address == 0) {
    return std::nullopt;
  }
  return Endpoint{destination->host_address, destination->host_port};
}

std::optional<Endpoint> Sdk2Device::destination(Stream stream) const {
  const bool on = stream == Stream::kPoints ? setting(Sdk2Key::kPointSend) == 0 : setting(Sdk2Key::kImuEnable) == 1;
  if (state_ != Sdk2DeviceState::kSampling || !on) {
    return std::nullopt;
  }
  return endpoint(stream == Stream::kPoints ? Sdk2Key::kPointDestination : Sdk2Key::kImuDestination);
}

}  // namespace slamd::emulation
