#include "tools/simulate/route.hpp"

#include <cmath>

namespace slamd::simulate {

namespace {

/// Smooths points [first, last] by repeated three-point means; both ends stay.
void smooth(std::vector<Eigen::Vector2d>& points, std::size_t first, std::size_t last, int passes) {
  std::vector<Eigen::Vector2d> next = points;
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t i = first + 1; i < last; ++i) {
      next[i] = 0.25 * points[i - 1] + 0.5 * points[i] + 0.25 * points[i + 1];
    }
    points.swap(next);
    points[first] = next[first];
    points[last] = next[last];
  }
}

}  // namespace

CentreLine centre_line(const Route& route, double length_m, bool sharp) {
  CentreLine line;
  const auto corner = [&](std::size_t i) { return route.corners[i % (route.corners.size() - 1)]; };
  double length = 0.0;
  for (std::size_t i = 0; length < length_m; ++i) {
    const Eigen::Vector2d from = corner(i);
    const Eigen::Vector2d to = corner(i + 1);
    if (sharp && i > 0 && i % 2 == 0) {
      line.turns.push_back(line.points.size());
    }
    const int pieces = std::max(1, static_cast<int>((to - from).norm() / CentreLine::kStep_m));
    for (int k = 0; k < pieces && length < length_m; ++k, length += CentreLine::kStep_m) {
      line.points.push_back(from + (to - from) * (static_cast<double>(k) / pieces));
    }
  }
  // A three-point mean spreads a corner by 1/√2 steps; n of them by √(n/2).
  const double spread = route.bend_m / CentreLine::kStep_m;
  const int passes = static_cast<int>(2.0 * spread * spread);
  std::size_t first = 0;
  for (const std::size_t turn : line.turns) {
    if (turn < line.points.size()) {
      smooth(line.points, first, turn, passes);
      first = turn;
    }
  }
  smooth(line.points, first, line.points.size() - 1, passes);
  return line;
}

}  // namespace slamd::simulate
