#pragma once

#include <cmath>
#include <cstdint>

namespace slamd::simulate {

/// Random numbers by position instead of by order: the same (seed, stream, index) always gives the same number, so that
/// rays may be cast by any number of threads. Source: SplitMix64's finaliser as a hash.
class Noise {
 public:
  Noise(std::uint64_t seed, std::uint64_t stream) : key_(mixed(seed * 0x9E3779B97F4A7C15ULL + stream)) {}

  /// Uniform in [0, 1).
  double uniform(std::uint64_t index) const {
    return static_cast<double>(mixed(key_ + index * 0xD1342543DE82EF95ULL) >> 11) * 0x1.0p-53;
  }

  /// Uniform in [low, high).
  double uniform(std::uint64_t index, double low, double high) const { return low + (high - low) * uniform(index); }

  /// Standard normal (Box and Muller); uses two uniforms.
  double normal(std::uint64_t index) const {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(2 * index)));
    return radius * std::cos(2.0 * M_PI * uniform(2 * index + 1));
  }

 private:
  static std::uint64_t mixed(std::uint64_t z) {
    z += 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }

  std::uint64_t key_;
};

}  // namespace slamd::simulate
