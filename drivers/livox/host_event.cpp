#include "drivers/livox/host_event.hpp"

#include <cstdio>

#include "drivers/livox/status_code.hpp"

namespace slamd::livox {

namespace {

std::string dotted(std::uint32_t address) {
  return std::to_string(address >> 24) + '.' + std::to_string(address >> 16 & 255U) + '.' +
         std::to_string(address >> 8 & 255U) + '.' + std::to_string(address & 255U);
}

std::string status_words(std::uint32_t code) {
  const StatusCode status = parse_status_code(code);
  std::string words = "synchronised by " + std::string(name_of(status.time_sync));
  for (const std::string_view concern : concerns_of(status)) {
    words += ", " + std::string(concern);
  }
  return words;
}

std::string extrinsic_words(const Sdk1Extrinsic& extrinsic) {
  if (extrinsic == Sdk1Extrinsic{}) {
    return " has no extrinsic stored";
  }
  const auto& [roll, pitch, yaw] = extrinsic.rpy_deg;
  const auto& [x, y, z] = extrinsic.xyz_mm;
  char text[160];
  std::snprintf(text, sizeof text, " has an extrinsic stored: xyz_m = [%.3f, %.3f, %.3f], rpy_deg = [%.6g, %.6g, %.6g]", 1e-3 * x,
                1e-3 * y, 1e-3 * z, roll, pitch, yaw);
  return text;
}

}  // namespace

std::string words_for(const HostEvent& event) {
  const std::string who = std::string(event.device.view());
  const std::string at = who + " at " + dotted(event.address);
  const std::string value = std::to_string(event.value);
  switch (event.kind) {
    case HostEventKind::kFound:
      return at + " was found";
    case HostEventKind::kWrongSubnet:
      return at + " is of another subnet than this host, and cannot be reached";
    case HostEventKind::kHeldByOther:
      return event.value == 0
                 ? who + " is held by another host: stop that one's driver or viewer, then this one takes over"
                 : who + " is held by another host: it is set to send to " + dotted(event.value) +
                       "; this one takes it back when it is set otherwise or restarts";
    case HostEventKind::kNotSeen:
      return (who.empty() ? "no device" : who) +
             std::string(" is not to be heard looking for a host: off, of another subnet, or held by another host");
    case HostEventKind::kNoAnswer:
      return at + " was found, but does not answer: a firewall, or another host's device";
    case HostEventKind::kConnected:
      return at + " is connected";
    case HostEventKind::kIdentified:
      return who + " has firmware " + dotted(event.value);
    case HostEventKind::kInitialising:
      return who + " initialises: " + value + " %";
    case HostEventKind::kStateChanged:
      return who + " is in work state " + value;
    case HostEventKind::kStatusChanged:
      return who + " says: " + status_words(event.value);
    case HostEventKind::kExtrinsicRead:
      return who + extrinsic_words(event.extrinsic);
    case HostEventKind::kCommandFailed:
      return who + (event.value == kNoResult ? " does not answer: " : " refuses with code " + value + ": ") +
             event.command;
    case HostEventKind::kTimeSet:
      return who + " was told the time";
    case HostEventKind::kSampling:
      return who + " samples";
    case HostEventKind::kStopped:
      return who + " was stopped";
    case HostEventKind::kLost:
      return at + " was lost: it has fallen silent";
    case HostEventKind::kRestarted:
      return at + " has restarted, and looks for a host";
    case HostEventKind::kSyncChanged:
      return who + " is synchronised by " + (event.value == 1 ? "ptp" : event.value == 2 ? "gps" : "none");
    case HostEventKind::kHealthChanged:
      return event.value == 0 ? who + " is well" : who + " reports health code " + value;
    case HostEventKind::kNoData:
      return who + " says that it samples, but nothing arrives: a firewall, or somebody else stopped it; it is set again";
    case HostEventKind::kTakenOver:
      return who + " sent to " + dotted(event.value) + " until now; it sends to this host from now on";
  }
  return who;
}

}  // namespace slamd::livox
