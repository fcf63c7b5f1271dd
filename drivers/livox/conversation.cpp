#include "drivers/livox/conversation.hpp"

namespace slamd::livox {

bool Conversation::meet(const DeviceCode& code, Endpoint device, HostOutput& out) {
  code_ = code;
  device_ = device;
  for (const HostInterface& here : config_.interfaces) {
    if ((here.address & here.netmask) == (device.address & here.netmask)) {
      host_address_ = here.address;
      told_wrong_subnet_.reset();
      told_not_seen_ = false;
      return true;
    }
  }
  if (told_wrong_subnet_ != code) {
    told_wrong_subnet_ = code;
    tell(HostEventKind::kWrongSubnet, out);
  }
  return false;
}

void Conversation::expect(std::uint32_t number, Stamp now) {
  expected_ = number;
  ++tries_;
  again_ = now + config_.answer_wait;
}

Patience Conversation::patience(Stamp now) const {
  if (!is_due(now)) {
    return Patience::kWait;
  }
  return tries_ < kTries ? Patience::kAskAgain : Patience::kGiveUp;
}

void Conversation::search() {
  searching_since_.reset();
  settle();
}

void Conversation::look(Stamp now, HostOutput& out) {
  if (!searching_since_) {
    searching_since_ = now;
  } else if (now - *searching_since_ > kNotSeenAfter && !told_not_seen_) {
    told_not_seen_ = true;
    out.events.try_push_back({HostEventKind::kNotSeen, config_.wanted, 0, 0, ""});
  }
}

void Conversation::send(const FrameBytes& bytes, std::uint16_t from_port, Endpoint to, HostOutput& out) {
  out.datagrams.try_push_back({from_port, to, bytes});
}

void Conversation::tell(HostEventKind kind, HostOutput& out, std::uint32_t value, const char* command) const {
  out.events.try_push_back({kind, code_, device_.address, value, command});
}

void Conversation::tell_extrinsic(const Sdk1Extrinsic& extrinsic, HostOutput& out) const {
  out.events.try_push_back({HostEventKind::kExtrinsicRead, code_, device_.address, 0, "", extrinsic});
}

}  // namespace slamd::livox
