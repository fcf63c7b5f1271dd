#include "tools/emulation/sdk1_device.hpp"

#include <algorithm>

#include "core/base/bytes.hpp"
#include "drivers/livox/data_header.hpp"
#include "drivers/transport/udp_receiver.hpp"

namespace slamd::emulation {

using livox::Endpoint;
using livox::FrameResult;
using livox::one_byte;
using livox::Payload;
using livox::Sdk1Command;
using livox::Sdk1Frame;
using livox::Sdk1FrameType;
using livox::Sdk1WorkState;

namespace {


// Of the status code.
constexpr std::uint32_t kPpsPresent = 1U << 9;
constexpr unsigned kTimeSyncShift = 14;

Duration since_1970(const livox::Sdk1Utc& utc) {
  const std::chrono::year_month_day date{std::chrono::year{utc.year}, std::chrono::month{utc.month},
                                         std::chrono::day{utc.day}};
  return std::chrono::sys_days{date}.time_since_epoch() + std::chrono::hours{utc.hour} +
         std::chrono::microseconds{utc.in_hour_us};
}

livox::Sdk1Utc utc_of(Duration since_1970) {
  const std::chrono::sys_time<Duration> time{since_1970};
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const auto hour = std::chrono::floor<std::chrono::hours>(time);
  const std::chrono::year_month_day date{day};
  livox::Sdk1Utc utc;
  utc.year = static_cast<std::uint16_t>(static_cast<int>(date.year()));
  utc.month = static_cast<std::uint8_t>(static_cast<unsigned>(date.month()));
  utc.day = static_cast<std::uint8_t>(static_cast<unsigned>(date.day()));
  utc.hour = static_cast<std::uint8_t>((hour - day) / std::chrono::hours{1});
  utc.in_hour_us = static_cast<std::uint32_t>((time - hour) / std::chrono::microseconds{1});
  return utc;
}

bool is_one(std::span<const std::byte> payload, std::uint8_t value) {
  return payload.size() == 1 && payload[0] == std::byte{value};
}

/// An answer of its result and more.
Payload with_result(const Payload& rest) {
  Payload payload = one_byte(kDone);
  for (const std::byte byte : rest) {
    payload.push_back(byte);
  }
  return payload;
}

}  // namespace

void Sdk1Device::receive(std::span<const std::byte> datagram, Endpoint from, std::uint16_t to_port, Stamp now,
                         DeviceOutput& out) {
  while (to_port == kCommandPort && !datagram.empty()) {
    Sdk1Frame frame;
    std::size_t size = 0;
    if (parse_sdk1_frame(datagram, frame, size) != FrameResult::kOk) {
      return;  // says nothing to what it does not understand
    }
    take(frame, from, now, out);
    datagram = datagram.subspan(size);
  }
}

void Sdk1Device::take(const Sdk1Frame& frame, Endpoint from, Stamp now, DeviceOutput& out) {
  if (frame.command == Sdk1Command::kHandshake && frame.type != Sdk1FrameType::kMessage) {
    take_handshake(frame, from, now, out);  // SDK 2.3.0 calls it an answer
    return;
  }
  if (frame.type != Sdk1FrameType::kCommand || state_ == Sdk1DeviceState::kLooking) {
    return;
  }
  const bool is_hosts = from.address == host_.host_address;
  const Payload answer = is_hosts ? answer_to(frame, now, out) : one_byte(kFailed);
  const Endpoint to = is_hosts ? Endpoint{host_.host_address, host_.command_port} : from;
  send(Sdk1FrameType::kAck, frame.sequence, frame.command, answer, to, out);
  if (is_hosts && frame.command == Sdk1Command::kDisconnect) {
    give_up("let it go", out);
  }
}

void Sdk1Device::take_handshake(const Sdk1Frame& frame, Endpoint from, Stamp now, DeviceOutput& out) {
  const auto handshake = livox::Sdk1Handshake::parse(frame.payload);
  if (!handshake) {
    return;
  }
  const bool free = state_ == Sdk1DeviceState::kLooking || handshake->host_address == host_.host_address;
  if (!free) {
    out.news.push_back("refuses " + transport::dotted(handshake->host_address) + ", for it is another host's");
    send(Sdk1FrameType::kAck, frame.sequence, frame.command, one_byte(kFailed), from, out);
    return;
  }
  host_ = *handshake;
  heard_ = now;
  state_ = Sdk1DeviceState::kHeld;
  out.news.push_back("is held by " + transport::dotted(host_.host_address));
  send(Sdk1FrameType::kAck, frame.sequence, frame.command, one_byte(kDone), {host_.host_address, host_.command_port}, out);
}

Payload Sdk1Device::answer_to(const Sdk1Frame& frame, Stamp now, DeviceOutput& out) {
  switch (frame.command) {
    case Sdk1Command::kHeartbeat:
      return heartbeat_answer(now);
    case Sdk1Command::kDeviceInfo:
      return livox::Sdk1DeviceInfo{kDone, config_.firmware}.bytes();
    case Sdk1Command::kSampling:
      return one_byte(sample(frame.payload, out));
    case Sdk1Command::kCoordinate:
      return one_byte(is_one(frame.payload, config_.coordinate) ? kDone : kFailed);
    case Sdk1Command::kSetReturnMode:
      return one_byte(is_one(frame.payload, config_.return_mode) ? kDone : kFailed);
    case Sdk1Command::kGetReturnMode:
      return with_result(one_byte(config_.return_mode));
    case Sdk1Command::kSetImuRate:
      return one_byte(set_imu_rate(frame.payload));
    case Sdk1Command::kGetImuRate:
      return with_result(one_byte(sends_imu_ ? 1 : 0));
    case Sdk1Command::kSetExtrinsic:
      return one_byte(set_extrinsic(frame.payload));
    case Sdk1Command::kGetExtrinsic:
      return with_result(extrinsic_.bytes());
    case Sdk1Command::kSetMode:
      return one_byte(set_mode(frame.payload, out));
    case Sdk1Command::kSetUtc:
      return one_byte(set_utc(frame.payload, now, out));
    case Sdk1Command::kDisconnect:
      return one_byte(kDone);
    default:
      return one_byte(kFailed);
  }
}

Payload Sdk1Device::heartbeat_answer(Stamp now) {
  heard_ = now;
  livox::Sdk1HeartbeatAck ack{kDone, work_, 0, status()};
  if (work_ == Sdk1WorkState::kInitialising && config_.boots > Duration{}) {
    ack.status_or_progress = static_cast<std::uint32_t>(100 * (now - power_up_) / config_.boots);
  }
  return ack.bytes();
}

std::uint8_t Sdk1Device::sample(std::span<const std::byte> payload, DeviceOutput& out) {
  const bool starts = is_one(payload, 1);
  if ((!starts && !is_one(payload, 0)) || work_ != Sdk1WorkState::kNormal) {
    return kFailed;
  }
  state_ = starts ? Sdk1DeviceState::kSampling : Sdk1DeviceState::kHeld;
  out.news.push_back(starts ? "samples" : "stops sampling");
  return kDone;
}

std::uint8_t Sdk1Device::set_mode(std::span<const std::byte> payload, DeviceOutput& out) {
  const auto mode = livox::result_of(payload);
  if (payload.size() != 1 || *mode < 1 || *mode > 3 || work_ == Sdk1WorkState::kInitialising) {
    return kFailed;
  }
  work_ = static_cast<Sdk1WorkState>(*mode);
  state_ = work_ == Sdk1WorkState::kNormal ? state_ : Sdk1DeviceState::kHeld;
  out.news.push_back(work_ == Sdk1WorkState::kNormal ? "wakes" : "rests");
  return kDone;
}

std::uint8_t Sdk1Device::set_imu_rate(std::span<const std::byte> payload) {
  if (!is_one(payload, 0) && !is_one(payload, 1)) {
    return kFailed;
  }
  sends_imu_ = is_one(payload, 1);
  return kDone;
}

std::uint8_t Sdk1Device::set_extrinsic(std::span<const std::byte> payload) {
  const auto extrinsic = livox::Sdk1Extrinsic::parse(payload);
  extrinsic_ = extrinsic.value_or(extrinsic_);
  return extrinsic ? kDone : kFailed;
}

std::uint8_t Sdk1Device::set_utc(std::span<const std::byte> payload, Stamp now, DeviceOutput& out) {
  utc_ = livox::Sdk1Utc::parse(payload);
  if (!utc_) {
    return kFailed;
  }
  ++utc_told_;
  const Stamp edge = config_.utc_minus_own ? edge_before(now) : now;
  if (now - edge < kUtcFrom || now - edge > kUtcUntil) {
    ++utc_unused_;
    return kDone;  // heard, but it says nothing of an edge
  }
  told_minus_own_ = since_1970(*utc_) - edge.time_since_epoch();
  if (sync_ != livox::TimeSync::kGps) {
    sync_ = livox::TimeSync::kGps;
    out.news.push_back("follows GPS");
  }
  return kDone;
}

Stamp Sdk1Device::edge_before(Stamp now) const {
  const Duration utc = now.time_since_epoch() + *config_.utc_minus_own;
  return now - (utc - std::chrono::floor<std::chrono::seconds>(utc));
}

std::uint32_t Sdk1Device::status() const {
  return status_ | static_cast<std::uint32_t>(sync_) << kTimeSyncShift | (config_.utc_minus_own ? kPpsPresent : 0U);
}

void Sdk1Device::stamp(std::span<std::byte> packet, Stamp taken) const {
  store_le(packet, 4, status());
  if (sync_ == livox::TimeSync::kPps) {
    packet[8] = static_cast<std::byte>(livox::TimestampType::kPps);
    store_le(packet, 10, static_cast<std::uint64_t>((taken - edge_before(taken)).count()));
  } else if (sync_ == livox::TimeSync::kGps) {
    packet[8] = static_cast<std::byte>(livox::TimestampType::kGps);
    const livox::Sdk1Utc date = utc_of(taken.time_since_epoch() + told_minus_own_);
    std::ranges::copy(date.bytes(), packet.begin() + 10);
  }
}

void Sdk1Device::give_up(const char* why, DeviceOutput& out) {
  out.news.push_back("looks for a host: " + transport::dotted(host_.host_address) + " " + why);
  state_ = Sdk1DeviceState::kLooking;
  host_ = {};
}

void Sdk1Device::advance(Stamp now, DeviceOutput& out) {
  if (work_ == Sdk1WorkState::kInitialising && now - power_up_ >= config_.boots) {
    work_ = Sdk1WorkState::kNormal;
  }
  if (sync_ == livox::TimeSync::kNone && config_.utc_minus_own && edge_before(now) > power_up_) {
    sync_ = livox::TimeSync::kPps;
    out.news.push_back("follows PPS");
  }
  if (state_ != Sdk1DeviceState::kLooking && now - heard_ > kGivesUpAfter) {
    give_up("has fallen silent", out);
  }
  if (state_ == Sdk1DeviceState::kLooking) {
    if (now >= next_broadcast_) {
      next_broadcast_ = now + kBroadcastEvery;
      send(Sdk1FrameType::kMessage, 0, Sdk1Command::kBroadcast, livox::Sdk1Broadcast{config_.code, config_.type, 0}.bytes(),
           {livox::kEverybody, kBroadcastPort}, out);
    }
  } else if (livox::parse_status_code(status()).system != livox::Severity::kNormal && now >= next_status_) {
    next_status_ = now + kStatusEvery;
    Payload code;
    for (unsigned shift = 0; shift < 32; shift += 8) {
      code.push_back(static_cast<std::byte>(status() >> shift));
    }
    send(Sdk1FrameType::kMessage, ++messages_, Sdk1Command::kAbnormalStatus, code, {host_.host_address, host_.command_port},
         out);
  }
}

std::optional<Endpoint> Sdk1Device::destination(Stream stream) const {
  if (state_ != Sdk1DeviceState::kSampling || (stream == Stream::kImu && !(sends_imu_ && host_.imu_port))) {
    return std::nullopt;
  }
  return Endpoint{host_.host_address, stream == Stream::kPoints ? host_.data_port : *host_.imu_port};
}

void Sdk1Device::send(Sdk1FrameType type, std::uint16_t number, Sdk1Command command, const Payload& payload, Endpoint to,
                      DeviceOutput& out) const {
  out.datagrams.push_back({kCommandPort, to, livox::write_sdk1_frame({type, number, command, payload.view()})});
}

}  // namespace slamd::emulation
