#pragma once

#include <array>
#include <cmath>

#include "tools/simulate/noise.hpp"

namespace slamd::simulate {

/// Uneven ground: a sum of waves in all directions.  Units: m.
class Waves {
 public:
  /// Five waves of the given lengths; each has a slope of at most `slope`.
  Waves(const Noise& noise, double shortest_m, double longest_m, double slope) {
    for (std::uint64_t i = 0; i < waves_.size(); ++i) {
      const double length = noise.uniform(900 + i, shortest_m, longest_m);
      const double heading = noise.uniform(910 + i, 0.0, 2.0 * M_PI);
      waves_[i] = {slope / (2.0 * M_PI) * length, 2.0 * M_PI * std::cos(heading) / length,
                   2.0 * M_PI * std::sin(heading) / length, noise.uniform(920 + i, 0.0, 2.0 * M_PI)};
    }
  }

  double height(double x, double y) const {
    double z = 0.0;
    for (const Wave& wave : waves_) {
      z += wave.amplitude * std::sin(wave.kx * x + wave.ky * y + wave.phase);
    }
    return z;
  }

 private:
  struct Wave {
    double amplitude;
    double kx;
    double ky;
    double phase;
  };
  std::array<Wave, 5> waves_{};
};

}  // namespace slamd::simulate
