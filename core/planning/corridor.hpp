#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/base/bounded_vector.hpp"
#include "core/base/fixed_vector.hpp"
#include "core/occupancy/state_map.hpp"

namespace slamd::planning {

/// The points p with normal · p ≤ offset_m.  Units: m; the normal has length 1.
struct HalfSpace {
  double normal[3];
  double offset_m;

  /// Returns how far a point lies inside; below zero: outside.
  double room(const Eigen::Vector3d& p) const { return offset_m - (normal[0] * p.x() + normal[1] * p.y() + normal[2] * p.z()); }
};

/// A convex piece of free space about one segment of a path: the points inside all planes.
struct Polyhedron {
  static constexpr std::size_t kPlanes = 64;

  FixedVector<HalfSpace, kPlanes> planes;

  /// Returns how far a point lies inside; below zero: outside.
  double room(const Eigen::Vector3d& p) const;
};

/// The ellipsoid that a polyhedron was grown about: d + C·u, |u| ≤ 1. It holds the segment, and the middle of no obstacle.
struct Ellipsoid {
  Eigen::Matrix3d C = Eigen::Matrix3d::Identity();
  Eigen::Vector3d d = Eigen::Vector3d::Zero();

  /// Returns |u| of a point: 1 on the surface.
  double level(const Eigen::Vector3d& p) const { return (C.inverse() * (p - d)).norm(); }
};

struct CorridorPiece {
  Ellipsoid ellipsoid;
  Polyhedron polyhedron;  // of the vehicle's whole body: its middle keeps radius_m away from each plane
};

struct CorridorConfig {
  double radius_m = 0.4;         // of the vehicle
  double reach_m = 2.0;          // of a polyhedron beyond its segment, on all sides
  bool unknown_blocks = true;    // whether unknown cells are obstacles
  double floor_m = 1e9;          // what lies lower than this below the segment's lower end is ground: no obstacle, but a plane
  std::size_t obstacles = 40'000;  // cells about one segment
};

enum class CorridorFault { kNone, kTooClose, kTooManyObstacles, kTooManyPlanes };

/// What became of a path.
struct CorridorResult {
  CorridorFault fault = CorridorFault::kNone;
  std::size_t segment = 0;  // the one at fault; all before it have their piece
};

/// Grows a chain of convex polyhedra about a path, one a segment, that hold it and no obstacle.
///
/// About each segment an ellipsoid is shrunk until no obstacle's middle is in it; its tangent planes at the nearest obstacle, the nearest of
/// the rest and so on bound the polyhedron, each moved to where the whole cell is outside. Where such a plane would leave the
/// vehicle less room on the segment than it needs, the plane half-way of the shortest connection of segment and cell stands
/// instead: if there is room at all, it has it. Two pieces share the vehicle's room about the path's corner between them.
/// Source: S. Liu et al., "Planning dynamically feasible trajectories for quadrotors using safe flight corridors in 3-D
/// complex environments", 2017, IV. Deviates: cells have their size, and the second kind of plane.
/// Frames: the map's, odom.  Real-time: allocates in the constructor only; one thread.
class CorridorBuilder {
 public:
  explicit CorridorBuilder(const CorridorConfig& config);

  /// Makes a piece for each segment of the path; `pieces` is as long as these at least.
  CorridorResult build(const occupancy::StateMap& map, std::span<const Eigen::Vector3d> path, BoundedVector<CorridorPiece>& pieces);

 private:
  CorridorFault grow(const occupancy::StateMap& map, const Eigen::Vector3d& from, const Eigen::Vector3d& to, CorridorPiece& piece);
  bool collect(const occupancy::StateMap& map, const Eigen::Vector3d& low, const Eigen::Vector3d& high);
  Ellipsoid shrunk(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  CorridorConfig config_;
  BoundedVector<Eigen::Vector3d> middles_;  // scratch, sized once: of the obstacles' cells
};

}  // namespace slamd::planning
