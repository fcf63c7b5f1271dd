#pragma once

#include <cstddef>
#include <optional>

#include "core/occupancy/state_map.hpp"

// What a planner asks of a map. All points are in odom; what lies outside the window is unknown.
namespace slamd::occupancy {

/// Returns the state at a point.
CellState state_at(const StateMap& map, const Eigen::Vector3d& p_odom);

struct CellCounts {
  std::size_t unknown = 0;
  std::size_t free = 0;
  std::size_t occupied = 0;
};

/// Counts the cells that a box touches. Units: m.
CellCounts count_cells(const StateMap& map, const Eigen::Vector3d& min_odom, const Eigen::Vector3d& max_odom);

/// What a ray meets.
struct RayHit {
  double distance_m = 0.0;  // from the ray's begin to the cell's middle
  CellIndex cell;
  CellState state = CellState::kOccupied;
};

/// Returns the first cell along a way that is occupied, or unknown where `unknown_blocks`; nothing where it is clear.
/// A way of more than 10,000 cells is cut to that.
std::optional<RayHit> cast_ray(const StateMap& map, const Eigen::Vector3d& from_odom, const Eigen::Vector3d& to_odom, bool unknown_blocks);

/// The nearest occupied cell.
struct Obstacle {
  double distance_m = 0.0;  // to the cell, not to its middle; 0 inside
  CellIndex cell;
};

/// Returns the nearest occupied cell within `radius_m`, or nothing, as for a point beyond 2³⁰ cells or none. O(blocks
/// within the distance found).
std::optional<Obstacle> nearest_obstacle(const StateMap& map, const Eigen::Vector3d& p_odom, double radius_m);

}  // namespace slamd::occupancy
