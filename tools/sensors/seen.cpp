#include "tools/sensors/seen.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::sensors {

bool InertialSeen::shows_gravity() const {
  constexpr std::uint64_t kFewest = 10;
  constexpr double kStandard_mps2 = 9.81;
  constexpr double kTolerance_mps2 = 0.5;
  constexpr double kShake_mps2 = 1.0;
  constexpr double kTurn_radps = 0.1;
  return samples.last_second >= kFewest && std::abs(mean_force_mps2.norm() - kStandard_mps2) < kTolerance_mps2 &&
         force_spread_mps2 < kShake_mps2 && mean_rate_radps.norm() < kTurn_radps;
}

bool Seen::anything() const {
  return !lidars.empty() || !rows.empty() ||
         std::any_of(avias.begin(), avias.end(), [](const AviaSeen& avia) { return avia.answer >= AviaAnswer::kRefusal; }) ||
         std::any_of(lines.begin(), lines.end(), [](const LineSeen& line) { return line.tongue != Tongue::kNone || line.answers; }) ||
         std::any_of(buses.begin(), buses.end(), [](const BusSeen& bus) { return bus.frames.total > 0; });
}

std::string printable(std::string text) {
  std::replace_if(text.begin(), text.end(), [](char c) { return c < 0x20 || c > 0x7E; }, '?');
  return text;
}

}  // namespace slamd::sensors
