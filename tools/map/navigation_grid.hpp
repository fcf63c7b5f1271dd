#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "tools/map/session_cloud.hpp"

namespace slamd::map {

struct GridOptions {
  double resolution_m = 0.2;
  double lowest_m = 0.25;   // above the ground under base: what is lower is driven over
  double highest_m = 1.8;   // what is higher is driven under
  double ground_m = 0.0;    // the ground's height in base's level frame: −(height of base)
  double reach_m = 30.0;    // from a keyframe
};

/// What navigation stacks read: a picture of the ground, each cell free, occupied or unknown.
/// Frames: map; row 0 is the lowest y.
struct NavigationGrid {
  enum class Cell : std::uint8_t { kUnknown, kFree, kOccupied };

  std::size_t width = 0;
  std::size_t height = 0;
  double resolution_m = 0.0;
  double x_m = 0.0;  // of the lower left corner
  double y_m = 0.0;
  std::vector<Cell> cells;

  Cell at(double x, double y) const;
};

/// Draws the grid of a session: from each keyframe a beam to each of its points; where points of the asked heights end is
/// occupied, unless four times as many beams went on through it; where beams only go through is free.
/// Errors: std::runtime_error where the session has no keyframe, or the grid more than 400 million cells.
NavigationGrid grid_of(const storage::Session& session, const GridOptions& options, const Share& share = {});

/// Writes STEM.pgm and STEM.yaml as map_server of ROS's navigation stacks has them. Errors: std::runtime_error.
void write_grid(const NavigationGrid& grid, const std::filesystem::path& stem);

}  // namespace slamd::map
