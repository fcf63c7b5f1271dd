#include "drivers/imu/inertial_result.hpp"

namespace slamd::imu {

namespace {

constexpr double kFastest_radps = 628.0;
constexpr double kHardest_mps2 = 981.0;

}  // namespace

const char* name_of(InertialResult result) {
  switch (result) {
    case InertialResult::kSample: return "sample";
    case InertialResult::kOther: return "other";
    case InertialResult::kIncomplete: return "incomplete";
    case InertialResult::kMalformed: return "malformed";
    case InertialResult::kNoTime: return "no_time";
    case InertialResult::kNotFinite: return "not_finite";
    case InertialResult::kOutOfRange: return "out_of_range";
  }
  return "?";
}

InertialResult judge(const sensor::ImuReading& reading) {
  if (!reading.angular_rate_radps.allFinite() || !reading.specific_force_mps2.allFinite()) {
    return InertialResult::kNotFinite;
  }
  const bool in_range = reading.angular_rate_radps.cwiseAbs().maxCoeff() <= kFastest_radps &&
                        reading.specific_force_mps2.cwiseAbs().maxCoeff() <= kHardest_mps2;
  return in_range ? InertialResult::kSample : InertialResult::kOutOfRange;
}

}  // namespace slamd::imu
