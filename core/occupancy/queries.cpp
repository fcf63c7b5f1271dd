#include "core/occupancy/queries.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/occupancy/ray_walk.hpp"

namespace slamd::occupancy {

namespace {

/// Units: cells.
constexpr double kLongestRay = 10'000.0;
constexpr double kFarthest = 1 << 30;  // from odom's origin, as in cell_of()

/// Returns how far a point lies from an axis-aligned cube. All in one unit.
double distance_to_cube(const Eigen::Vector3d& p, const Eigen::Vector3d& corner, double side) {
  return (corner - p).cwiseMax(p - corner - Eigen::Vector3d::Constant(side)).cwiseMax(0.0).norm();
}

}  // namespace

CellState state_at(const StateMap& map, const Eigen::Vector3d& p_odom) { return map.at(cell_of(p_odom, map.cell_m())); }

CellCounts count_cells(const StateMap& map, const Eigen::Vector3d& min_odom, const Eigen::Vector3d& max_odom) {
  const CellIndex low = cell_of(min_odom, map.cell_m());
  const CellIndex high = cell_of(max_odom, map.cell_m());
  const auto side = [](std::int32_t from, std::int32_t to) { return static_cast<std::size_t>(std::max<std::int64_t>(0, std::int64_t{to} - from + 1)); };
  const std::size_t all = side(low.x, high.x) * side(low.y, high.y) * side(low.z, high.z);
  // What is unknown outside the window is not walked through.
  const Window& window = map.window();
  const auto first = [](std::int32_t from, std::int32_t window_first) { return std::max(from, kBlockSide * window_first); };
  const auto last = [](std::int32_t to, std::int32_t window_first, std::int32_t size) { return std::min(to, kBlockSide * (window_first + size) - 1); };
  CellCounts counts;
  for (std::int32_t z = first(low.z, window.first.z); z <= last(high.z, window.first.z, window.size[2]); ++z) {
    for (std::int32_t y = first(low.y, window.first.y); y <= last(high.y, window.first.y, window.size[1]); ++y) {
      for (std::int32_t x = first(low.x, window.first.x); x <= last(high.x, window.first.x, window.size[0]); ++x) {
        const CellState state = map.at({x, y, z});
        counts.free += state == CellState::kFree ? 1 : 0;
        counts.occupied += state == CellState::kOccupied ? 1 : 0;
      }
    }
  }
  counts.unknown = all - counts.free - counts.occupied;
  return counts;
}

std::optional<RayHit> cast_ray(const StateMap& map, const Eigen::Vector3d& from_odom, const Eigen::Vector3d& to_odom, bool unknown_blocks) {
  if (!from_odom.allFinite() || !to_odom.allFinite()) {
    return std::nullopt;
  }
  const double longest_m = kLongestRay * map.cell_m();
  const Eigen::Vector3d way = to_odom - from_odom;
  const Eigen::Vector3d end_odom = way.norm() > longest_m ? Eigen::Vector3d(from_odom + longest_m * way.stableNormalized()) : to_odom;
  // In cells from the one of `from`, so that single precision suffices.
  const CellIndex begin = cell_of(from_odom, map.cell_m());
  const Eigen::Vector3d corner = map.cell_m() * Eigen::Vector3d(begin.x, begin.y, begin.z);
  const auto local = [&](const Eigen::Vector3d& p) { return Eigen::Vector3f(((p - corner) / map.cell_m()).cast<float>()); };
  std::optional<RayHit> hit;
  walk_ray(local(from_odom), local(end_odom), [&](const std::array<std::int32_t, 3>& step, std::int32_t) {
    const CellIndex cell{begin.x + step[0], begin.y + step[1], begin.z + step[2]};
    const CellState state = map.at(cell);
    if (state == CellState::kOccupied || (unknown_blocks && state == CellState::kUnknown)) {
      hit = RayHit{(centre_of(cell, map.cell_m()) - from_odom).norm(), cell, state};
    }
    return !hit;
  });
  return hit;
}

std::optional<Obstacle> nearest_obstacle(const StateMap& map, const Eigen::Vector3d& p_odom, double radius_m) {
  const Window& window = map.window();
  const Eigen::Vector3d p = p_odom / map.cell_m();  // in cells from here on
  if (!(p.cwiseAbs().array() <= kFarthest).all()) {
    return std::nullopt;
  }
  const BlockIndex home = cell_of(p_odom, map.cell_m()).block();
  double best = radius_m / map.cell_m();
  std::optional<Obstacle> found;
  const auto look_into = [&](const BlockIndex& index) {
    const Eigen::Vector3d corner = kBlockSide * Eigen::Vector3d(index.x, index.y, index.z);
    if (!window.contains(index) || distance_to_cube(p, corner, kBlockSide) > best) {
      return;
    }
    const BlockStates& block = map.block(window.slot_of(index));
    for (int word = 0; word < kBlockSide; ++word) {
      for (std::uint64_t left = block.occupied[static_cast<std::size_t>(word)]; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        const CellIndex cell{kBlockSide * index.x + (bit & 7), kBlockSide * index.y + (bit >> 3), kBlockSide * index.z + word};
        const double distance = distance_to_cube(p, Eigen::Vector3d(cell.x, cell.y, cell.z), 1.0);
        if (distance < best || (!found && distance <= best)) {
          best = distance;
          found = Obstacle{distance * map.cell_m(), cell};
        }
      }
    }
  };
  if (!window.contains(home)) {
    for (std::size_t slot = 0; slot < map.size(); ++slot) {
      look_into(window.block_at(slot));
    }
    return found;
  }
  // Shells of blocks about the point's own, until a whole one is farther than what was found.
  const std::int32_t farthest = std::max({window.size[0], window.size[1], window.size[2]});
  for (std::int32_t shell = 0; shell <= farthest && kBlockSide * (shell - 1) <= best; ++shell) {
    for (std::int32_t dz = -shell; dz <= shell; ++dz) {
      for (std::int32_t dy = -shell; dy <= shell; ++dy) {
        const bool is_face = std::abs(dz) == shell || std::abs(dy) == shell;
        for (std::int32_t dx = -shell; dx <= shell; dx += is_face ? 1 : std::max(1, 2 * shell)) {
          look_into({home.x + dx, home.y + dy, home.z + dz});
        }
      }
    }
  }
  return found;
}

}  // namespace slamd::occupancy
