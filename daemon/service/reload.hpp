#pragma once

#include <string>
#include <vector>

#include "daemon/configuration/configuration.hpp"

namespace slamd::service {

/// What became of a configuration that was read again: "realtime.priority 50 → 60" each.
struct Reload {
  std::vector<std::string> taken;    // in effect from now on
  std::vector<std::string> refused;  // wait for a restart
};

/// Takes over into `running` the keys that may change while slamd runs (Key::is_live), and names
/// the others that differ.
Reload take_over(configuration::Configuration& running, const configuration::Configuration& wanted);

/// Says it in one sentence.
std::string in_words(const Reload& reload);

}  // namespace slamd::service
