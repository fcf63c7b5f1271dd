#pragma once

#include <string>

#include "core/sensor/gnss_fix.hpp"

namespace slamd::replay {

/// What an emulated receiver speaks.
enum class GnssTalk { kNmea, kUbx, kBoth };

/// What a receiver sends of one moment: RMC, GGA and GST, or NAV-PVT, or all of them. A fix that is not good is told as
/// none. Its UTC must be known.
std::string message_of(const sensor::GnssFix& fix, GnssTalk talk);

}  // namespace slamd::replay
