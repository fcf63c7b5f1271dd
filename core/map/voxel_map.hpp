#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "core/map/cell_table.hpp"
#include "core/map/nearest.hpp"
#include "core/map/point_grid.hpp"
#include "core/map/surface_cell.hpp"

namespace slamd::map {

/// Sizes of the local map.
struct VoxelMapConfig {
  float cell_m = 1.0F;          // fine cells; also the search radius that is exact
  float surface_cell_m = 0.5F;  // coarse cells of the swarm's likelihood; a second level has three times the side
  float window_m = 150.0F;      // path length after which an untouched cell is forgotten
  std::size_t max_cells = 60'000;
  std::size_t max_surface_cells = 120'000;
};

/// The local map of the odometry: recent points for exact neighbours, and surfaces for the swarm.
///
/// It holds what was touched within the last window_m of path, or what fits, whichever is less: a robot that comes
/// back must not snap to walls that its own drift has displaced.
/// Frames: odom.  Units: m.
/// Real-time: allocates in the constructor only; odometry thread only.
class VoxelMap {
 public:
  /// Levels of the coarse grid: surface_cell_m, and three times that for the first steps of the swarm.
  static constexpr std::size_t kSurfaceLevels = 2;

  explicit VoxelMap(const VoxelMapConfig& config);

  /// Takes points in and forgets what has left the window.
  void insert(std::span<const Eigen::Vector3f> points_odom, double path_m);

  /// Finds the nearest stored points, nearest first: exact within `radius_m` ≤ cell_m.
  Neighbours nearest(const Eigen::Vector3f& query_odom, float radius_m) const {
    return grid_.nearest(query_odom, radius_m);
  }

  /// Brings what `nearest` will look at nearer to the processor, some queries ahead.
  void prefetch(const Eigen::Vector3f& query_odom) const { grid_.prefetch(query_odom); }

  /// Returns the surface cell around a point, or nullptr where nothing is known. O(1).
  const SurfaceCell* surface(const Eigen::Vector3f& query_odom, std::size_t level) const;

  void clear();
  bool empty() const { return grid_.cells() == 0; }
  std::size_t cells() const { return grid_.cells(); }
  std::uint64_t recycled() const { return grid_.recycled(); }
  const VoxelMapConfig& config() const { return config_; }

  /// The fine cells by their places, for a copy that is made in parts.
  const CellTable<PointCell>& fine_cells() const { return grid_.table(); }

  /// Calls visit(p_odom) for every stored point.
  template <typename Visit>
  void for_each_point(Visit&& visit) const {
    grid_.for_each_point(visit);
  }

 private:
  void insert_surfaces(std::span<const Eigen::Vector3f> points_odom, float path_m, std::size_t level);

  VoxelMapConfig config_;
  std::array<float, kSurfaceLevels> inverse_surface_cell_{};
  PointGrid grid_;
  std::array<CellTable<SurfaceCell>, kSurfaceLevels> surfaces_;
};

}  // namespace slamd::map
