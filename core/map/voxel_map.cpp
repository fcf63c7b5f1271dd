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
  constexpr std::size_t kAhead = 8;
  for (std::size_t i = 0; i < points_odom.size(); ++i) {
    if (i + kAhead < points_odom.size()) {
      prefetch(points_odom[i + kAhead]);
    }
    const Eigen::Vector3f& p = points_odom[i];
    grid_.insert(p, path);
    for (std::size_t level = 0; level < kSurfaceLevels; ++level) {
      surfaces_[level].touch(key_of(p, inverse_surface_cell_[level]), path).add(p);
    }
  }
}

void VoxelMap::prefetch(const Eigen::Vector3f& p_odom) const {
  grid_.prefetch(p_odom);
  for (std::size_t level = 0; level < kSurfaceLevels; ++level) {
    surfaces_[level].prefetch(key_of(p_odom, inverse_surface_cell_[level]));
  }
}

const SurfaceCell* VoxelMap::surface(const Eigen::Vector3f& query_odom, std::size_t level) const {
  return surfaces_[level].find(key_of(query_odom, inverse_surface_cell_[level]));
}

}  // namespace slamd::map
