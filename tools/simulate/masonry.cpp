#include "tools/simulate/masonry.hpp"

namespace slamd::simulate {

void add_wall(World& world, const Wall& wall, const std::vector<Gap>& gaps) {
  double from = wall.from;
  const auto piece = [&](double to) {
    if (to - from > 0.01) {
      const double half = 0.5 * wall.thickness;
      const Eigen::Vector3d low = wall.along_x ? Eigen::Vector3d(from, wall.at - half, wall.bottom)
                                               : Eigen::Vector3d(wall.at - half, from, wall.bottom);
      const Eigen::Vector3d high =
          wall.along_x ? Eigen::Vector3d(to, wall.at + half, wall.top) : Eigen::Vector3d(wall.at + half, to, wall.top);
      add_block(world, low, high, wall.reflectivity, wall.transparency);
    }
  };
  for (const Gap& gap : gaps) {
    piece(std::min(gap.from, wall.to));
    from = std::max(from, gap.to);
  }
  piece(wall.to);
}

void add_tree(World& world, const Eigen::Vector2d& place, double trunk_m, double radius_m, double free_path_m) {
  const double ground = world.ground(place.x(), place.y());
  world.add(Cylinder{place, 0.06 * radius_m + 0.05, ground - 0.5, ground + trunk_m + 0.5 * radius_m, 0.3F});
  world.add(Crown{{place.x(), place.y(), ground + trunk_m + 0.8 * radius_m}, radius_m, free_path_m, 0.25F});
}

}  // namespace slamd::simulate
