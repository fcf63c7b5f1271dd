#pragma once

#include <array>
#include <cstdint>

#include "tools/simulate/noise.hpp"
#include "tools/simulate/world.hpp"

namespace slamd::simulate {

/// How a LiDAR errs.
struct RangeErrors {
  double noise_m = 0.012;       // of each range
  double beam_bias_m = 0.005;   // of each laser, fixed
  double max_range_m = 100.0;
  double min_range_m = 0.4;
  double full_signal = 1.2e-5;  // reflectivity · cos / range² from which on nothing is lost
  bool mixed_pixels = false;    // beams have a width: edges give ranges in between, or two echoes
  double divergence_rad = 3e-3;
  double drops_per_m = 0.0;     // rain or dust: chance of an echo from the air in each metre
};

/// One echo of a shot.
struct Echo {
  double range_m = 0.0;
  double signal = 0.0;
  Reflectivity reflectivity = 0.0F;
  bool air = false;    // from rain or dust
  bool mixed = false;  // from two surfaces at once
};

/// The echoes of a shot in the order of their ranges.
struct Echoes {
  std::array<Echo, 3> echo;
  int count = 0;

  void add(const Echo& found);
  const Echo* strongest() const;
};

/// Shoots at a world as a real receiver sees it: lost echoes, noise, air, and beams that are no lines.
class Beam {
 public:
  Beam(const World& world, const RangeErrors& errors, const Noise& noise)
      : world_(world), errors_(errors), noise_(noise) {}

  /// `number` is the shot's own; `bias_m` its laser's. The result depends on nothing else.
  Echoes shoot(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_s, std::uint64_t number,
               double bias_m) const;

  const RangeErrors& errors() const { return errors_; }

 private:
  void add_surfaces(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_s, std::uint64_t number,
                    Echoes& echoes) const;
  void add_air(std::uint64_t number, Echoes& echoes) const;

  const World& world_;
  RangeErrors errors_;
  Noise noise_;
};

}  // namespace slamd::simulate
