#include "tests/world/room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamd::world {

namespace {

struct Block {
  Eigen::Vector3d min_m;
  Eigen::Vector3d max_m;
};

/// The hall itself (seen from inside) and what stands in it (seen from outside).
const Block kHall{{-9.0, -6.0, 0.0}, {11.0, 7.0, 4.0}};
const Block kFurniture[] = {
    {{3.0, 2.0, 0.0}, {3.6, 2.6, 4.0}},   {{-4.0, -3.0, 0.0}, {-3.5, -2.5, 4.0}}, {{6.0, -4.5, 0.0}, {6.4, -1.0, 2.5}},
    {{-7.0, 3.0, 0.0}, {-5.0, 4.5, 1.2}}, {{0.5, 4.5, 0.0}, {2.0, 5.2, 0.8}},     {{8.0, 3.0, 0.0}, {9.0, 5.0, 1.5}},
};

}  // namespace

double Room::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  const auto crossing = [&](const Block& block, bool inside) {
    double enter = -std::numeric_limits<double>::infinity();
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      const double inverse = 1.0 / direction[axis];
      double a = (block.min_m[axis] - origin[axis]) * inverse;
      double b = (block.max_m[axis] - origin[axis]) * inverse;
      if (a > b) {
        std::swap(a, b);
      }
      enter = std::max(enter, a);
      leave = std::min(leave, b);
    }
    if (inside) {
      return leave;
    }
    return enter <= leave && enter > 0.0 ? enter : std::numeric_limits<double>::infinity();
  };
  double range = crossing(kHall, true);
  for (const Block& block : kFurniture) {
    range = std::min(range, crossing(block, false));
  }
  return range;
}

Eigen::Vector3d Room::direction(int column, int columns, int line) {
  const double azimuth = -2.0 * M_PI * column / columns;  // clockwise seen from above
  const double elevation = (2.0 * line - 15.0) * M_PI / 180.0;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

std::vector<Eigen::Vector3f> Room::points_lidar(const geometry::Se3& T_odom_lidar,
                                                int columns,
                                                double noise_m,
                                                std::mt19937_64& engine) const {
  const sensor::Scan still = scan(Stamp{}, std::chrono::milliseconds(100), columns, noise_m, engine,
                                  [&](double) { return T_odom_lidar; });
  std::vector<Eigen::Vector3f> points;
  for (const sensor::Point& point : still.points) {
    points.emplace_back(point.x_m, point.y_m, point.z_m);
  }
  return points;
}

}  // namespace slamd::world
