#include "daemon/devices/device_words.hpp"

#include "drivers/livox/status_code.hpp"
#include "drivers/transport/udp_receiver.hpp"

namespace slamd::devices {

using livox::HostEvent;
using livox::HostEventKind;

namespace {

std::string concerns_in(std::uint32_t status_code) {
  std::string words;
  for (const std::string_view concern : livox::concerns_of(livox::parse_status_code(status_code))) {
    words += (words.empty() ? "" : ", ") + std::string(concern);
  }
  return words;
}

/// What a device lacks that is told the UTC; empty: nothing.
std::string_view lacks_of(const livox::StatusCode& status) {
  if (status.time_sync == livox::TimeSync::kGps || status.time_sync == livox::TimeSync::kPtp) {
    return {};
  }
  if (!status.pps_present) {
    return "hears no PPS, and so cannot use the UTC that it is told";
  }
  return status.time_sync == livox::TimeSync::kPps ? "follows PPS, but has taken no UTC yet" : "hears PPS, but does not follow it yet";
}

}  // namespace

DeviceWords::DeviceWords(bool shared_clock, bool told_utc)
    : shared_clock_(shared_clock), told_utc_(told_utc), lacks_(lacks_of({})) {}

void DeviceWords::take(const HostEvent& event) {
  held_ = event.kind == HostEventKind::kHeldByOther || (held_ && event.kind == HostEventKind::kNotSeen);
  switch (event.kind) {
    case HostEventKind::kNotSeen:
      if (held_) {
        break;  // that is why
      }
      busy_ = "not to be heard: off, of another subnet, or another host's";
      break;
    case HostEventKind::kWrongSubnet:
      busy_ = transport::dotted(event.address) + " is of another subnet than this host";
      break;
    case HostEventKind::kHeldByOther:
      busy_ = "held by another host" + (event.value == 0 ? "" : ", " + transport::dotted(event.value));
      break;
    case HostEventKind::kNoAnswer:
      busy_ = "found, but does not answer";
      break;
    case HostEventKind::kInitialising:
      busy_ = "initialises, " + std::to_string(event.value) + " %";
      break;
    case HostEventKind::kCommandFailed:
      busy_ = (event.value == livox::kNoResult ? "does not answer: " : "refuses to ") + std::string(event.command);
      break;
    case HostEventKind::kNoData:
      busy_ = "samples, but nothing arrives";
      break;
    case HostEventKind::kLost:
      busy_ = "lost, looked for again";
      abnormal_.clear();
      break;
    case HostEventKind::kRestarted:
      busy_ = "has restarted";
      abnormal_.clear();
      break;
    case HostEventKind::kStatusChanged:
      abnormal_ = concerns_in(event.value);
      lacks_ = lacks_of(livox::parse_status_code(event.value));
      follows_none_ = livox::parse_status_code(event.value).time_sync == livox::TimeSync::kNone;
      break;
    case HostEventKind::kSyncChanged:
      follows_none_ = event.value == 0;
      break;
    case HostEventKind::kHealthChanged:
      abnormal_ = event.value == 0 ? "" : "reports health code " + std::to_string(event.value);
      break;
    case HostEventKind::kFound:
    case HostEventKind::kConnected:
    case HostEventKind::kSampling:
      busy_.clear();
      break;
    case HostEventKind::kIdentified:
    case HostEventKind::kStateChanged:
    case HostEventKind::kExtrinsicRead:
    case HostEventKind::kTimeSet:
    case HostEventKind::kStopped:
    case HostEventKind::kTakenOver:
      break;
  }
}

std::string DeviceWords::cause(bool samples, std::string_view state_name) const {
  if (samples && abnormal_.empty() && told_utc_ && !lacks_.empty()) {
    return std::string(lacks_);
  }
  if (samples && abnormal_.empty() && shared_clock_ && follows_none_) {
    return "follows no clock, though lidar.clock is \"shared\"";
  }
  if (samples || (busy_.empty() && !abnormal_.empty())) {
    return abnormal_;
  }
  return busy_.empty() ? std::string(state_name) : busy_;
}

}  // namespace slamd::devices
