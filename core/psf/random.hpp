#pragma once

#include <cmath>
#include <cstdint>

namespace slamd::psf {

/// A small random generator with the same stream on every machine, seeded per scan so that a replay is repeatable.
/// Source: SplitMix64 (Steele, Lea and Flood, 2014).
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t scan_index) : state_(seed * 0xD1342543DE82EF95ULL + scan_index) { next(); }

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

  /// Uniform in [-1, 1).
  double symmetric() { return 2.0 * uniform() - 1.0; }

  /// Standard normal (Box and Muller).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * M_PI * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace slamd::psf
