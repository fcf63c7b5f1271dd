#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/sensor/imu_reading.hpp"

namespace slamd::imu {

/// What became of a good frame of an inertial sensor; all but the first three are refusals.
enum class InertialResult : std::uint8_t {
  kSample,
  kOther,         // an answer, or a message without inertial data
  kIncomplete,    // acceleration without turn rate, or the reverse: another rate of output
  kMalformed,     // lengths that contradict themselves
  kNoTime,        // nothing that counts time: see the output configuration
  kNotFinite,
  kOutOfRange,    // faster than 100 turns a second, or more than 100 g
};

inline constexpr std::size_t kInertialResults = 7;

/// Names a result as reports and health spell it.
const char* name_of(InertialResult result);

struct InertialCounters {
  std::array<std::uint64_t, kInertialResults> frames{};  // by InertialResult
  std::uint64_t missing = 0;                             // samples lost or damaged, by the device's own count
  std::uint64_t clipped = 0;                             // samples that the device says are at its limits

  std::uint64_t of(InertialResult result) const { return frames[static_cast<std::size_t>(result)]; }
};

/// Judges the values of a sample: kSample, kNotFinite or kOutOfRange.
InertialResult judge(const sensor::ImuReading& reading);

}  // namespace slamd::imu
