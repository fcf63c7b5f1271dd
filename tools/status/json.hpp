#pragma once

#include <string>

#include "tools/status/listener.hpp"

namespace slamd::status {

/// Everything that has been heard as one line of JSON; SI units, names as in docs/protocol.md. What was not heard is null.
std::string to_json(const Heard& heard, Clock::time_point now);

}  // namespace slamd::status
