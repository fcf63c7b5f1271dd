#include <cmath>

#include "tools/simulate/masonry.hpp"
#include "tools/simulate/scenery.hpp"
#include "tools/simulate/waves.hpp"

namespace slamd::simulate {

namespace {

constexpr double kSize_m = 240.0;

/// Lawns with slopes of up to 8 %: five waves of 1.6 % each at most, that seldom agree.
double lawn(const Waves& waves, double x, double y) { return waves.height(x, y); }

bool far_from(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p, double distance_m) {
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Eigen::Vector2d d = corners[i + 1] - corners[i];
    const double share = std::clamp((p - corners[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    if ((corners[i] + share * d - p).norm() < distance_m) {
      return false;
    }
  }
  return true;
}

/// A long building of three floors with windows set back, and a roof that stands out.
void add_hall(World& world, const Eigen::Vector2d& centre, double half_x, double half_y, double yaw, double height) {
  const double ground = world.ground(centre.x(), centre.y());
  const Eigen::Vector2d ahead(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  world.add(OrientedBox{
      {centre.x(), centre.y(), ground + 0.5 * height - 2.0}, {half_x, half_y, 0.5 * height + 2.0}, yaw, 0.5F});
  world.add(OrientedBox{{centre.x(), centre.y(), ground + height + 0.2}, {half_x + 0.6, half_y + 0.6, 0.2}, yaw, 0.3F});
  for (double s = -half_x + 1.5; s < half_x; s += 3.0) {
    for (const double side : {-1.0, 1.0}) {
      const Eigen::Vector2d p = centre + s * ahead + side * (half_y + 0.15) * left;
      world.add(OrientedBox{{p.x(), p.y(), ground + 0.5 * height - 2.0}, {0.25, 0.15, 0.5 * height + 2.0}, yaw, 0.45F});
    }
  }
}

}  // namespace

Scenery make_campus(std::uint64_t seed, const Extras& extras) {
  const Noise noise(seed, 100);
  const Waves waves(noise, 70.0, 160.0, 0.023);
  World world([&](double x, double y) { return lawn(waves, x, y); }, {kSize_m, kSize_m}, seed);
  Route route;
  route.bend_m = 4.0;
  route.floor = [waves](double x, double y) { return lawn(waves, x, y); };
  // Two loops that share a path, gone in both directions.
  route.corners = {{60, 60}, {120, 50}, {185, 65}, {190, 120}, {120, 115}, {120, 50}, {60, 60}, {50, 125}, {120, 115},
                   {125, 180}, {60, 185}, {50, 125}, {120, 115}, {190, 120}, {185, 65}, {120, 50},
                   {120, 115}, {50, 125}, {60, 60}};
  for (std::size_t i = 0; i + 1 < route.corners.size(); ++i) {
    // The same place gets the same shift.
    const auto place = static_cast<std::uint64_t>(route.corners[i].x() * 1000.0 + route.corners[i].y());
    route.corners[i] += Eigen::Vector2d(noise.uniform(place, -6.0, 6.0), noise.uniform(place + 1, -6.0, 6.0));
  }
  route.corners.back() = route.corners.front();
  // Few buildings, far apart.
  const Eigen::Vector2d halls[] = {{88, 88}, {155, 88}, {85, 150}, {165, 165}, {25, 205}, {215, 25}, {25, 25}};
  for (std::uint64_t i = 0; i < 7; ++i) {
    const double half_x = noise.uniform(i + 10, 9.0, 14.0);
    add_hall(world, halls[i], half_x, noise.uniform(i + 20, 5.0, 7.5), noise.uniform(i + 30, 0.0, M_PI),
             noise.uniform(i + 40, 6.0, 12.0));
  }
  // Trees stand in loose groups; the rest is grass.
  for (std::uint64_t i = 0; i < 110; ++i) {
    const std::uint64_t group = i / 4;
    const Eigen::Vector2d middle(noise.uniform(2000 + group, 8.0, kSize_m - 8.0),
                                 noise.uniform(2100 + group, 8.0, kSize_m - 8.0));
    const Eigen::Vector2d place =
        middle + Eigen::Vector2d(noise.uniform(2200 + i, -9.0, 9.0), noise.uniform(2400 + i, -9.0, 9.0));
    const bool inside = (place.array() > 4.0).all() && (place.array() < kSize_m - 4.0).all();
    if (inside && far_from(route.corners, place, 4.5)) {
      add_tree(world, place, noise.uniform(2600 + i, 1.6, 3.0), noise.uniform(2800 + i, 1.5, 3.4),
               noise.uniform(3000 + i, 0.7, 1.8));
    }
  }
  // Lamps along the paths, and a bench here and there.
  for (std::size_t i = 0; i + 1 < route.corners.size(); ++i) {
    const Eigen::Vector2d d = route.corners[i + 1] - route.corners[i];
    const Eigen::Vector2d right = Eigen::Vector2d(d.y(), -d.x()).normalized();
    for (double s = 12.0; s < d.norm() - 8.0; s += 24.0) {
      const Eigen::Vector2d lamp = route.corners[i] + s * d.normalized() + 3.2 * right;
      if (!far_from(route.corners, lamp, 2.5)) {
        continue;
      }
      const double ground = world.ground(lamp.x(), lamp.y());
      world.add(Cylinder{lamp, 0.06, ground - 0.3, ground + 4.0, 0.5F});
      if (noise.uniform(4000 + i) < 0.5) {
        world.add(OrientedBox{{lamp.x() + 1.2, lamp.y(), ground + 0.42}, {0.9, 0.22, 0.05}, 0.0, 0.4F});
      }
    }
  }
  add_traffic(world, route.corners, extras, noise);
  world.build();
  return {std::move(world), std::move(route), seed};
}

}  // namespace slamd::simulate
