#pragma once

namespace slamd::graph {

/// What a sum of three squared standard normals stays below in 99 of 100 cases: χ²₃(0.99). The others likewise.
inline constexpr double kChiSquared99Of3 = 11.345;
/// χ²₆(0.999).
inline constexpr double kChiSquared999Of6 = 22.458;

/// χ²₆(0.9999): for tests that one true loop has to pass against many others.
inline constexpr double kChiSquared9999Of6 = 27.856;

}  // namespace slamd::graph
