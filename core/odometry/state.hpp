#pragma once

#include <cstdint>
#include <string>

namespace slamd::odometry {

/// How much of the pose to believe (design.md, "States").
enum class State : std::uint8_t { kStarting, kTracking, kDegraded, kLost };

/// Why it is not better.
enum class Cause : std::uint8_t {
  kNone,
  kAligning,          // the inertial sensor is being levelled
  kNoImu,             // configured, but silent: at constant velocity
  kImuGap,
  kFewConstraints,    // too little of the scan meets the map
  kFewInliers,
  kLargeInnovation,   // the scan contradicts the prediction
  kDegenerate,        // a direction that the scan does not see
  kSaturated,         // the inertial sensor says the most that it can
  kUnconfirmed,       // after a gap, a loss or saturation: the map has not yet agreed often enough
  kMapRestarted,      // the old map was not found again: it goes on where the pose is believed to be
  kNoLidar,           // no scan any more: the pose goes on from the other sensors
};

const char* name_of(State state);
const char* name_of(Cause cause);

/// Says a cause in words, and of a weak direction which it is, as seen from the vehicle.
std::string in_words(Cause cause, std::uint8_t weak_axes_base);

}  // namespace slamd::odometry
