#pragma once

#include <string>
#include <string_view>

#include "drivers/livox/host_event.hpp"

namespace slamd::devices {

/// What is wrong with a device, or what it is busy with, in words short enough for health: made of the events of its host.
class DeviceWords {
 public:
  /// With a shared clock, a device that follows no other clock is a fault; one that is told the UTC should follow GPS, or PTP,
  /// which it prefers.
  explicit DeviceWords(bool shared_clock = false, bool told_utc = false);

  void take(const livox::HostEvent& event);

  /// What to say in a state of the host's; empty: all is well.
  std::string cause(bool samples, std::string_view state_name) const;

 private:
  bool shared_clock_;
  bool told_utc_;
  std::string_view lacks_;  // of what following GPS takes, as its status says
  bool follows_none_ = false;
  bool held_ = false;     // by another host, when something was last told
  std::string busy_;      // until it samples
  std::string abnormal_;  // also while it samples
};

}  // namespace slamd::devices
