#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/simulate/motion.hpp"
#include "tools/simulate/world.hpp"

namespace slamd::simulate {

/// The road surface: long waves of a few decimetres, slopes of up to about 3 %.
class Road {
 public:
  explicit Road(const Noise& noise);

  double height(double x, double y) const;

 private:
  struct Wave {
    double amplitude;
    double kx;
    double ky;
    double phase;
  };
  std::array<Wave, 5> waves_{};
};

/// A town of streets on a jittered grid: façades with depth, kerbs, parked cars, poles, porous trees, fences, uneven
/// ground. Everything follows from the seed.
class Town {
 public:
  explicit Town(std::uint64_t seed);

  const World& world() const { return world_; }

  /// Returns a tour along the streets that comes back to where it began, long enough for `duration_s` at `speed_mps`:
  /// at rest for `rest_s` first, slower in bends, with a stop now and then.
  /// `height_m` is base above the road.
  Motion tour(double duration_s, double speed_mps, double rest_s, double height_m) const;

 private:
  void add_block(int column, int row);
  void add_building(const Eigen::Vector2d& centre, const Eigen::Vector2d& half, std::uint64_t index);
  void add_facade(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double top_m, double bottom_m, std::uint64_t index);
  void add_street_side(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint64_t index);
  std::vector<Eigen::Vector2d> centre_line(double length_m) const;

  std::uint64_t seed_;
  Noise noise_;
  std::vector<double> streets_x_;  // centre lines of the streets that run along y
  std::vector<double> streets_y_;
  Road road_;
  World world_;
};

}  // namespace slamd::simulate
