#pragma once

#include <vector>

#include "tools/simulate/world.hpp"

namespace slamd::simulate {

/// An interval along a wall.
struct Gap {
  double from = 0.0;
  double to = 0.0;
};

/// Adds a box between two corners.
inline void add_block(World& world, const Eigen::Vector3d& low, const Eigen::Vector3d& high, Reflectivity reflectivity,
                      float transparency = 0.0F) {
  world.add(OrientedBox{0.5 * (low + high), 0.5 * (high - low), 0.0, reflectivity, transparency});
}

/// A wall along x (or y) with openings.
struct Wall {
  bool along_x = true;
  double at = 0.0;  // of its middle, across
  double from = 0.0;
  double to = 0.0;
  double bottom = 0.0;
  double top = 2.8;
  double thickness = 0.12;
  Reflectivity reflectivity = 0.6F;
  float transparency = 0.0F;
};

/// Adds the pieces of a wall beside its gaps, which are sorted and do not overlap.
void add_wall(World& world, const Wall& wall, const std::vector<Gap>& gaps);

/// Adds a tree: trunk and crown.
void add_tree(World& world, const Eigen::Vector2d& place, double trunk_m, double radius_m, double free_path_m);

}  // namespace slamd::simulate
