#pragma once

#include <string>
#include <string_view>

#include "drivers/livox/host_event.hpp"

namespace slamd::devices {

/// What is wrong with a device, or what it is busy with, in words short enough for health: made of the events of its host.
class DeviceWords {
 public:
  void take(const livox::HostEvent& event);

  /// What to say in a state of the host's; empty: all is well.
  std::string cause(bool samples, std::string_view state_name) const;

 private:
  bool held_ = false;     // by another host, when something was last told
  std::string busy_;      // until it samples
  std::string abnormal_;  // also while it samples
};

}  // namespace slamd::devices
