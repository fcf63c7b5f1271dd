#pragma once

#include <cstdint>
#include <numbers>

namespace slamd {

/// One degree. Units: rad.
inline constexpr double kDegree = std::numbers::pi / 180.0;

/// The g of data sheets and protocols, by definition. Units: m/s².
inline constexpr double kStandardGravity_mps2 = 9.80665;

inline constexpr std::uint64_t kNanosecondsPerSecond = 1'000'000'000;

}  // namespace slamd
