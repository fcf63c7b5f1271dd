#pragma once

namespace slamd::graph {

/// What a sum of n squared standard normals stays below in 99 of 100 cases: χ²ₙ(0.99).
inline constexpr double kChiSquared99Of3 = 11.345;
inline constexpr double kChiSquared99Of6 = 16.812;

/// χ²₆(0.9999): for tests that one true loop has to pass against many others.
inline constexpr double kChiSquared9999Of6 = 27.856;

}  // namespace slamd::graph
