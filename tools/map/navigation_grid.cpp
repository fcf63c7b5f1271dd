#include "tools/map/navigation_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace slamd::map {

using Cell = NavigationGrid::Cell;

namespace {

constexpr std::size_t kMostCells = 400'000'000;
constexpr int kBeamsThrough = 4;  // to each point that ends in a cell, before it counts as gone

/// Beams that ended in a cell and beams that went through.
struct Tally {
  std::uint16_t ends = 0;
  std::uint16_t through = 0;
};

void count_up(std::uint16_t& count) { count += count < std::numeric_limits<std::uint16_t>::max() ? 1 : 0; }

struct Index {
  long x = 0;
  long y = 0;
};

/// Calls visit for the cells from a to b without the last (Bresenham).
template <typename Visit>
void walk(Index a, Index b, Visit&& visit) {
  const long dx = std::labs(b.x - a.x);
  const long dy = -std::labs(b.y - a.y);
  const long step_x = a.x < b.x ? 1 : -1;
  const long step_y = a.y < b.y ? 1 : -1;
  long error = dx + dy;
  while (a.x != b.x || a.y != b.y) {
    visit(a);
    const long twice = 2 * error;
    if (twice >= dy) {
      error += dy;
      a.x += step_x;
    }
    if (twice <= dx) {
      error += dx;
      a.y += step_y;
    }
  }
}

}  // namespace

Cell NavigationGrid::at(double x, double y) const {
  const auto column = static_cast<long>(std::floor((x - x_m) / resolution_m));
  const auto row = static_cast<long>(std::floor((y - y_m) / resolution_m));
  if (column < 0 || row < 0 || column >= static_cast<long>(width) || row >= static_cast<long>(height)) {
    return Cell::kUnknown;
  }
  return cells[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)];
}

NavigationGrid grid_of(const storage::Session& session, const GridOptions& options, const Share& share) {
  // What lies within reach of a keyframe, at heights that are driven over or stand in the way.
  const auto is_seen = [&](const Eigen::Vector3f& p_level) {
    return p_level.head<2>().norm() < static_cast<float>(options.reach_m) &&
           p_level.z() < static_cast<float>(options.ground_m + options.highest_m);
  };
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    const geometry::Se3 T = T_map_level(session, i);
    for (const Eigen::Vector3f& p_level : session.keyframes[i].cloud_level) {
      if (is_seen(p_level)) {
        const Eigen::Vector2d p = (T * p_level.cast<double>()).head<2>();
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
    }
    low = low.cwiseMin(T.translation().head<2>());
    high = high.cwiseMax(T.translation().head<2>());
  }
  if (session.keyframes.empty()) {
    throw std::runtime_error("the session has no keyframe: there is nothing to draw");
  }
  NavigationGrid grid;
  grid.resolution_m = options.resolution_m;
  const Eigen::Vector2d size = (high - low) / options.resolution_m;
  if (!((size.x() + 3.0) * (size.y() + 3.0) < static_cast<double>(kMostCells))) {
    throw std::runtime_error("the grid would have more than 400 million cells: ask for a coarser one");
  }
  grid.x_m = low.x() - options.resolution_m;
  grid.y_m = low.y() - options.resolution_m;
  grid.width = static_cast<std::size_t>(size.x()) + 3;
  grid.height = static_cast<std::size_t>(size.y()) + 3;
  std::vector<Tally> tallies(grid.width * grid.height);
  const auto index_of = [&](const Eigen::Vector3d& p) {
    return Index{static_cast<long>((p.x() - grid.x_m) / options.resolution_m), static_cast<long>((p.y() - grid.y_m) / options.resolution_m)};
  };
  const auto tally_at = [&](const Index& index) -> Tally& {
    return tallies[static_cast<std::size_t>(index.y) * grid.width + static_cast<std::size_t>(index.x)];
  };
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    const geometry::Se3 T = T_map_level(session, i);
    const Index from = index_of(T.translation());
    for (const Eigen::Vector3f& p_level : session.keyframes[i].cloud_level) {
      if (!is_seen(p_level)) {
        continue;
      }
      const Index to = index_of(T * p_level.cast<double>());
      walk(from, to, [&](const Index& index) { count_up(tally_at(index).through); });
      const bool stands_up = p_level.z() > static_cast<float>(options.ground_m + options.lowest_m);
      count_up(stands_up ? tally_at(to).ends : tally_at(to).through);
    }
    if (share) {
      share(static_cast<double>(i + 1) / static_cast<double>(session.keyframes.size()));
    }
  }
  grid.cells.reserve(tallies.size());
  for (const Tally& tally : tallies) {
    grid.cells.push_back(tally.ends > 0 && tally.through <= kBeamsThrough * tally.ends ? Cell::kOccupied
                         : tally.through > 0                                           ? Cell::kFree
                                                                                       : Cell::kUnknown);
  }
  return grid;
}

void write_grid(const NavigationGrid& grid, const std::filesystem::path& stem) {
  std::filesystem::path picture = stem;
  picture += ".pgm";
  std::filesystem::path description = stem;
  description += ".yaml";
  std::ofstream pgm(picture, std::ios::binary);
  pgm << "P5\n" << grid.width << ' ' << grid.height << "\n255\n";
  std::string row(grid.width, ' ');
  for (std::size_t y = grid.height; y-- > 0;) {  // pictures begin at the top
    for (std::size_t x = 0; x < grid.width; ++x) {
      const Cell cell = grid.cells[y * grid.width + x];
      row[x] = static_cast<char>(cell == Cell::kOccupied ? 0 : cell == Cell::kFree ? 254 : 205);
    }
    pgm << row;
  }
  pgm.close();
  char text[256];
  std::snprintf(text, sizeof text, "resolution: %.6g\norigin: [%.6f, %.6f, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
                grid.resolution_m, grid.x_m, grid.y_m);
  std::ofstream yaml(description);
  yaml << "image: " << picture.filename().string() << "\n" << text;
  yaml.close();
  if (!pgm || !yaml) {
    throw std::runtime_error(picture.string() + " and " + description.filename().string() + ": cannot be written");
  }
}

}  // namespace slamd::map
