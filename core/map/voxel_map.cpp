#include "core/map/voxel_map.hpp"

namespace slamd::map {

VoxelMap::VoxelMap(const VoxelMapConfig& config)
    : config_(config),
      inverse_surface_cell_{1.0F / config.surface_cell_m, 1.0F / (3.0F * config.surface_cell_m)},
      grid_(config.cell_m, config.max_cells),
      surfaces_{CellTable<SurfaceCell>(config.max_surface_cells),
                CellTable<SurfaceCell>(config.max_surface_cells / 6)} {}

void VoxelMap::clear() {
  grid_.clear();
  for (auto& level : surfaces_) {
    level.clear();
  }
}

void VoxelMap::insert(std::span<const Eigen::Vector3f> points_odom, double path_m) {
  const auto path = static_cast<float>(path_m);
  const float oldest = path - config_.window_m;
  grid_.forget_before(oldest);
  for (auto& level : surfaces_) {
    level.forget_before(oldest);
  }
  grid_.insert(points_odom, path);
  for (std::size_t level = 0; level < kSurfaceLevels; ++level) {
    insert_surfaces(points_odom, path, level);
  }
}

void VoxelMap::insert_surfaces(std::span<const Eigen::Vector3f> points_odom, float path_m, std::size_t level) {
  // Of each point first the slot is fetched, then the cell, then it is used: by then both have come.
  constexpr std::size_t kCellAhead = 6;
  constexpr std::size_t kSlotAhead = 12;
  constexpr std::size_t kKeys = 16;
  std::array<geometry::CellKey, kKeys> keys;  // of the points ahead, in turn
  CellTable<SurfaceCell>& cells = surfaces_[level];
  const float inverse_side = inverse_surface_cell_[level];
  for (std::size_t i = 0; i < points_odom.size() + kSlotAhead; ++i) {
    if (i < points_odom.size()) {
      keys[i % kKeys] = geometry::key_of(points_odom[i], inverse_side);
      cells.prefetch_slot(keys[i % kKeys]);
    }
    const std::size_t next = i - (kSlotAhead - kCellAhead);  // wraps before the first
    if (next < points_odom.size()) {
      const std::uint32_t place = cells.place_of(keys[next % kKeys]);
      if (place != CellTable<SurfaceCell>::kNone) {
        cells.prefetch(place);
      }
    }
    const std::size_t now = i - kSlotAhead;
    if (now < points_odom.size()) {
      cells.touch(keys[now % kKeys], path_m).add(points_odom[now]);
    }
  }
}

const SurfaceCell* VoxelMap::surface(const Eigen::Vector3f& query_odom, std::size_t level) const {
  return surfaces_[level].find(geometry::key_of(query_odom, inverse_surface_cell_[level]));
}

}  // namespace slamd::map
