#include "core/odometry/state.hpp"

#include "core/odometry/localisability.hpp"

namespace slamd::odometry {

const char* name_of(State state) {
  switch (state) {
    case State::kStarting: return "STARTING";
    case State::kTracking: return "TRACKING";
    case State::kDegraded: return "DEGRADED";
    case State::kLost: return "LOST";
  }
  return "?";
}

const char* name_of(Cause cause) {
  switch (cause) {
    case Cause::kNone: return "none";
    case Cause::kAligning: return "aligning the inertial sensor";
    case Cause::kNoImu: return "no inertial samples";
    case Cause::kImuGap: return "gap in the inertial samples";
    case Cause::kFewConstraints: return "too little of the scan meets the map";
    case Cause::kFewInliers: return "the scan does not fit the map";
    case Cause::kLargeInnovation: return "the scan contradicts the prediction";
    case Cause::kDegenerate: return "a direction that the scan does not see";
    case Cause::kSaturated: return "the inertial sensor is at its limit";
    case Cause::kUnconfirmed: return "the map has not yet confirmed the pose";
    case Cause::kMapRestarted: return "the old map was not found again, a new one begun";
    case Cause::kNoLidar: return "no scans";
  }
  return "?";
}

std::string in_words(Cause cause, std::uint8_t weak_axes_base) {
  const std::string words = name_of(cause);
  return cause == Cause::kDegenerate ? words + ": " + in_words(weak_axes_base) : words;
}

}  // namespace slamd::odometry
