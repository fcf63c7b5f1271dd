#include <algorithm>
#include <cmath>

#include "tools/loopnet/place_world.hpp"
#include "tools/simulate/masonry.hpp"
#include "tools/simulate/waves.hpp"

namespace slamd::loopnet {

namespace {

using simulate::Noise;
using simulate::OrientedBox;

/// A closed path that wanders around the middle.
std::vector<Eigen::Vector2d> wandering(const Noise& noise, double extent_m, std::uint64_t stream) {
  std::vector<Eigen::Vector2d> path;
  constexpr int kPoints = 72;
  for (int i = 0; i <= kPoints; ++i) {
    const double turn = 2.0 * M_PI * (i % kPoints) / kPoints;
    double radius = 0.33 * extent_m;
    for (int wave = 1; wave <= 4; ++wave) {
      const std::uint64_t number = stream + static_cast<std::uint64_t>(2 * wave);
      radius += extent_m * noise.uniform(number, -0.05, 0.05) * std::sin(wave * turn + noise.uniform(number + 1, 0.0, 6.3));
    }
    path.emplace_back(0.5 * extent_m + radius * std::cos(turn), 0.5 * extent_m + radius * std::sin(turn));
  }
  return path;
}

double distance_to(const std::vector<std::vector<Eigen::Vector2d>>& lanes, const Eigen::Vector2d& p) {
  double best = 1e9;
  for (const std::vector<Eigen::Vector2d>& lane : lanes) {
    for (std::size_t i = 0; i + 1 < lane.size(); ++i) {
      const Eigen::Vector2d d = lane[i + 1] - lane[i];
      const double share = std::clamp((p - lane[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
      best = std::min(best, (lane[i] + share * d - p).norm());
    }
  }
  return best;
}

}  // namespace

/// Parks, campuses, yards and woods: free paths, buildings that stand at any angle, few or many trees, bushes and poles.
PlaceWorld make_grounds(std::uint64_t seed) {
  const Noise noise(seed, 700);
  const double extent_m = noise.uniform(1, 150.0, 280.0);
  const simulate::Waves waves(noise, 50.0, 160.0, noise.uniform(2, 0.0, 0.025));
  const auto height = [waves](double x, double y) { return waves.height(x, y); };
  PlaceWorld park{{height, {extent_m, extent_m}, seed, {}, 2.0}, {wandering(noise, extent_m, 100)}, height, false};
  const auto crossing = [&](std::uint64_t number) {
    const std::vector<Eigen::Vector2d>& path = park.lanes[0];
    return path[static_cast<std::size_t>(noise.uniform(number) * static_cast<double>(path.size() - 1))];
  };
  for (std::uint64_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d a = crossing(200 + i);
    const Eigen::Vector2d b = crossing(210 + i);
    if ((a - b).norm() > 40.0) {
      park.lanes.push_back({a, b});
    }
  }
  const auto place = [&](std::uint64_t number) {
    return Eigen::Vector2d(noise.uniform(number, 3.0, extent_m - 3.0), noise.uniform(number + 1, 3.0, extent_m - 3.0));
  };
  const auto buildings = static_cast<std::uint64_t>(noise.uniform(3, 0.0, 22.0));
  for (std::uint64_t i = 0; i < buildings; ++i) {
    const std::uint64_t number = 1000 + 20 * i;
    const Eigen::Vector2d p = place(number);
    const Eigen::Vector3d half(noise.uniform(number + 2, 3.0, 20.0), noise.uniform(number + 3, 3.0, 9.0),
                               noise.uniform(number + 4, 1.5, 8.0));
    if (distance_to(park.lanes, p) < half.head<2>().norm() + 3.0) {
      continue;
    }
    const double yaw = noise.uniform(number + 5, 0.0, M_PI);
    const double ground = park.world.ground(p.x(), p.y());
    park.world.add(OrientedBox{{p.x(), p.y(), ground + half.z() - 1.0}, half + Eigen::Vector3d(0, 0, 1), yaw, 0.5F});
    const Eigen::Vector2d ahead(std::cos(yaw), std::sin(yaw));
    const Eigen::Vector2d left(-ahead.y(), ahead.x());
    if (noise.uniform(number + 6) < 0.6) {  // a wing
      const Eigen::Vector2d wing = p + noise.uniform(number + 7, -1.0, 1.0) * half.x() * ahead + half.y() * left;
      park.world.add(OrientedBox{{wing.x(), wing.y(), ground + 0.6 * half.z() - 1.0},
                                 {noise.uniform(number + 8, 1.5, 5.0), noise.uniform(number + 9, 1.0, 2.8), 0.6 * half.z() + 1.0},
                                 yaw, 0.5F});
    }
    const double bay = noise.uniform(number + 10, 2.0, 6.0);
    for (double s = -half.x() + 0.5 * bay; s < half.x(); s += bay) {
      for (const double side : {-1.0, 1.0}) {
        const Eigen::Vector2d q = p + s * ahead + side * (half.y() + 0.2) * left;
        park.world.add(OrientedBox{{q.x(), q.y(), ground + half.z() - 1.0}, {0.3, 0.2, half.z() + 1.0}, yaw, 0.45F});
      }
    }
  }
  const double density = std::exp(noise.uniform(4, std::log(0.0006), std::log(0.013)));  // trees per m²
  const auto trees = static_cast<std::uint64_t>(density * extent_m * extent_m);
  const double clump_m = noise.uniform(5, 4.0, 40.0);
  const double tall = noise.uniform(6, 0.6, 1.6);
  for (std::uint64_t i = 0; i < trees; ++i) {
    const std::uint64_t number = 100'000 + 10 * i;
    const Eigen::Vector2d p = place(200'000 + 2 * (i / 5)) + Eigen::Vector2d(noise.uniform(number, -clump_m, clump_m),
                                                                           noise.uniform(number + 1, -clump_m, clump_m));
    const bool inside = (p.array() > 3.0).all() && (p.array() < extent_m - 3.0).all();
    if (!inside || distance_to(park.lanes, p) < 2.8) {
      continue;
    }
    const double draw = noise.uniform(number + 2);
    const double ground = park.world.ground(p.x(), p.y());
    if (draw < 0.68) {
      simulate::add_tree(park.world, p, tall * noise.uniform(number + 3, 1.2, 3.5), tall * noise.uniform(number + 4, 0.8, 3.2),
                         noise.uniform(number + 5, 0.5, 2.2));
    } else if (draw < 0.9) {  // a bush
      const double radius = noise.uniform(number + 3, 0.4, 1.4);
      park.world.add(simulate::Crown{{p.x(), p.y(), ground + 0.7 * radius}, radius, noise.uniform(number + 4, 0.2, 0.8), 0.3F});
    } else if (draw < 0.96) {  // a lamp or post
      park.world.add(simulate::Cylinder{p, noise.uniform(number + 3, 0.04, 0.15), ground - 0.5,
                                        ground + noise.uniform(number + 4, 0.8, 6.0), 0.5F});
    } else {  // a kiosk, a container, a rock
      const Eigen::Vector3d half(noise.uniform(number + 3, 0.4, 3.0), noise.uniform(number + 4, 0.4, 1.2),
                                 noise.uniform(number + 5, 0.3, 1.3));
      if (distance_to(park.lanes, p) > half.x() + 2.0) {
        park.world.add(OrientedBox{{p.x(), p.y(), ground + half.z()}, half, noise.uniform(number + 6, 0.0, M_PI), 0.5F});
      }
    }
  }
  add_passers_by(park, noise, 2, 10);
  park.world.build();
  return park;
}

}  // namespace slamd::loopnet
