#include "core/map/voxel_map.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::map {

namespace {

struct Offset {
  std::int32_t x, y, z;
};

/// The 26 cells around one, faces first, corners last: the likeliest to hold a nearer point come first.
constexpr std::array<Offset, 26> neighbour_offsets() {
  std::array<Offset, 26> offsets{};
  std::size_t n = 0;
  for (std::int32_t distance = 1; distance <= 3; ++distance) {
    for (std::int32_t x = -1; x <= 1; ++x) {
      for (std::int32_t y = -1; y <= 1; ++y) {
        for (std::int32_t z = -1; z <= 1; ++z) {
          if (x * x + y * y + z * z == distance) {
            offsets[n++] = {x, y, z};
          }
        }
      }
    }
  }
  return offsets;
}

constexpr std::array<Offset, 26> kNeighbourOffsets = neighbour_offsets();

/// Squared distance from a place inside a cell to the neighbouring layer on one side. Units: cells².
float gap_sq(std::int32_t step, float fraction) {
  const float gap = step < 0 ? fraction : (step > 0 ? 1.0F - fraction : 0.0F);
  return gap * gap;
}

}  // namespace

VoxelMap::VoxelMap(const VoxelMapConfig& config)
    : config_(config),
      inverse_cell_(1.0F / config.cell_m),
      inverse_surface_cell_{1.0F / config.surface_cell_m, 1.0F / (3.0F * config.surface_cell_m)},
      search_(fastest_cell_search()),
      cells_(config.max_cells),
      surfaces_{CellTable<SurfaceCell>(config.max_surface_cells),
                CellTable<SurfaceCell>(config.max_surface_cells / 6)} {}

void VoxelMap::clear() {
  cells_.clear();
  for (auto& level : surfaces_) {
    level.clear();
  }
}

void VoxelMap::insert_point(const Eigen::Vector3f& p_odom, float path_m) {
  PointCell& cell = cells_.touch(key_of(p_odom, inverse_cell_), path_m);
  std::uint32_t place = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float scaled = p_odom[axis] * inverse_cell_;
    const float fraction = scaled - std::floor(scaled);
    const auto division = std::min(
        PointCell::kDivisions - 1, static_cast<std::uint32_t>(fraction * static_cast<float>(PointCell::kDivisions)));
    place = place * PointCell::kDivisions + division;
  }
  const std::uint64_t bit = std::uint64_t{1} << place;
  if ((cell.occupied & bit) != 0) {
    return;
  }
  cell.occupied |= bit;
  cell.x_m[cell.count] = p_odom.x();
  cell.y_m[cell.count] = p_odom.y();
  cell.z_m[cell.count] = p_odom.z();
  ++cell.count;
}

void VoxelMap::insert(std::span<const Eigen::Vector3f> points_odom, double path_m) {
  const auto path = static_cast<float>(path_m);
  const float oldest = path - config_.window_m;
  cells_.forget_before(oldest);
  for (auto& level : surfaces_) {
    level.forget_before(oldest);
  }
  for (const Eigen::Vector3f& p : points_odom) {
    insert_point(p, path);
    for (std::size_t level = 0; level < kSurfaceLevels; ++level) {
      surfaces_[level].touch(key_of(p, inverse_surface_cell_[level]), path).add(p);
    }
  }
}

Neighbours VoxelMap::nearest(const Eigen::Vector3f& query_odom, float radius_m) const {
  Neighbours best;
  const float radius_sq = radius_m * radius_m;
  const std::int32_t x = cell_index(query_odom.x(), inverse_cell_);
  const std::int32_t y = cell_index(query_odom.y(), inverse_cell_);
  const std::int32_t z = cell_index(query_odom.z(), inverse_cell_);
  const Eigen::Vector3f fraction =
      query_odom * inverse_cell_ -
      Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  if (const PointCell* cell = cells_.find(pack(x, y, z))) {
    search_(*cell, query_odom, radius_sq, best);
  }
  const float cell_sq = config_.cell_m * config_.cell_m;
  for (const Offset& offset : kNeighbourOffsets) {
    const float gap = gap_sq(offset.x, fraction.x()) + gap_sq(offset.y, fraction.y()) + gap_sq(offset.z, fraction.z());
    if (gap * cell_sq >= best.limit_sq(radius_sq)) {
      continue;
    }
    if (const PointCell* cell = cells_.find(pack(x + offset.x, y + offset.y, z + offset.z))) {
      search_(*cell, query_odom, radius_sq, best);
    }
  }
  return best;
}

const SurfaceCell* VoxelMap::surface(const Eigen::Vector3f& query_odom, std::size_t level) const {
  return surfaces_[level].find(key_of(query_odom, inverse_surface_cell_[level]));
}

}  // namespace slamd::map
