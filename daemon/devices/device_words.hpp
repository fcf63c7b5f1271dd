#pragma once

#include <string>
#include <string_view>

#include "drivers/livox/host_event.hpp"

namespace slamd::devices {

/// What is wrong with a device, or what it is busy with, in words short enough for health: made of the events of its host.
class DeviceWords {
 public:
  /// With a shared clock, a device that follows no other clock is a fault.
  explicit DeviceWords(bool shared_clock = false) : shared_clock_(shared_clock) {}

  void take(const livox::HostEvent& event);

  /// What to say in a state of the host's; empty: all is well.
  std::string cause(bool samples, std::string_view state_name) const;

 private:
  bool shared_clock_;
  bool follows_none_ = false;
  bool held_ = false;     // by another host, when something was last told
  std::string busy_;      // until it samples
  std::string abnormal_;  // also while it samples
};

}  // namespace slamd::devices
