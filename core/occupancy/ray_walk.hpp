#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

namespace slamd::occupancy {

/// Walks the cells of side 1 along a ray, from the one that holds `from` to the one that holds `to`, both included, each
/// step across a face. Calls visit(cell, steps that are left), which returns whether to go on.
/// The number of steps along each axis is fixed at the start, so that rounding cannot lead past the end.
/// Source: Amanatides and Woo, "A fast voxel traversal algorithm for ray tracing", 1987.
/// Real-time: no allocation.
template <typename Visit>
void walk_ray(const Eigen::Vector3f& from, const Eigen::Vector3f& to, Visit&& visit) {
  using Cell = std::array<std::int32_t, 3>;
  const auto cell_at = [](float x) { return static_cast<std::int32_t>(std::floor(x)); };
  Cell cell{cell_at(from.x()), cell_at(from.y()), cell_at(from.z())};
  Cell step{};
  Cell left{};
  std::array<float, 3> next{};   // of the ray's length, at which the next face is crossed
  std::array<float, 3> width{};  // from face to face
  std::int32_t steps = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const float d = to[axis] - from[axis];
    const std::int32_t crossings = cell_at(to[axis]) - cell[i];
    step[i] = crossings < 0 ? -1 : 1;
    left[i] = std::abs(crossings);
    steps += left[i];
    const float face = static_cast<float>(crossings < 0 ? cell[i] : cell[i] + 1);
    width[i] = crossings != 0 ? 1.0F / std::abs(d) : 0.0F;
    next[i] = crossings != 0 ? (face - from[axis]) / d : std::numeric_limits<float>::infinity();
  }
  while (visit(cell, steps) && steps > 0) {
    const std::size_t axis = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    cell[axis] += step[axis];
    next[axis] = --left[axis] > 0 ? next[axis] + width[axis] : std::numeric_limits<float>::infinity();
    --steps;
  }
}

}  // namespace slamd::occupancy
