#include <algorithm>
#include <cmath>

#include "tools/simulate/masonry.hpp"
#include "tools/simulate/scenery.hpp"

namespace slamd::simulate {

namespace {

constexpr double kLength_m = 320.0;
constexpr double kDepth_m = 240.0;
constexpr double kEdge_m = 60.0;   // of the quay; the water is south of it
constexpr double kWater_m = -3.5;
const Eigen::Vector3d kContainer(12.19, 2.44, 2.59);

/// Containers in rows, up to four high, some turned the wrong way round.
void add_stack(World& world, const Eigen::Vector2d& corner, int columns, int rows, const Noise& noise,
               std::uint64_t index) {
  for (int column = 0; column < columns; ++column) {
    for (int row = 0; row < rows; ++row, index += 8) {
      const int high = static_cast<int>(noise.uniform(index) * 4.2);
      for (int level = 0; level < high; ++level) {
        const auto number = index + static_cast<std::uint64_t>(level);
        const Eigen::Vector3d half = 0.5 * kContainer;
        const Eigen::Vector2d place =
            corner + Eigen::Vector2d(column * (kContainer.x() + 0.6), row * (kContainer.y() + 0.5)) +
            Eigen::Vector2d(noise.uniform(number + 3, -0.08, 0.08), noise.uniform(number + 4, -0.05, 0.05));
        world.add(OrientedBox{{place.x() + half.x(), place.y() + half.y(), (level + 0.5) * kContainer.z()},
                              half,
                              noise.uniform(number + 5, -0.01, 0.01),
                              static_cast<Reflectivity>(noise.uniform(number + 6, 0.2, 0.6))});
      }
    }
  }
}

/// A gantry crane over the quay's edge: four legs, a portal, and a boom over the water.
void add_crane(World& world, double x, const Noise& noise, std::uint64_t index) {
  const double height = noise.uniform(index, 28.0, 34.0);
  for (const double dx : {-8.0, 8.0}) {
    for (const double y : {kEdge_m + 4.0, kEdge_m + 22.0}) {
      add_block(world, {x + dx - 0.6, y - 0.6, 0.0}, {x + dx + 0.6, y + 0.6, height}, 0.5F);
      add_block(world, {x + dx - 1.5, y - 0.5, 0.2}, {x + dx + 1.5, y + 0.5, 1.4}, 0.4F);
    }
    add_block(world, {x + dx - 0.4, kEdge_m + 4.0, 12.0}, {x + dx + 0.4, kEdge_m + 22.0, 13.2}, 0.5F);
  }
  for (const double y : {kEdge_m + 4.0, kEdge_m + 22.0}) {
    add_block(world, {x - 8.0, y - 0.4, 10.0}, {x + 8.0, y + 0.4, 11.4}, 0.5F);
  }
  add_block(world, {x - 1.5, kEdge_m - 42.0, height}, {x + 1.5, kEdge_m + 40.0, height + 2.0}, 0.5F);
}

}  // namespace

Scenery make_harbour(std::uint64_t seed, const Extras& extras) {
  const Noise noise(seed, 500);
  // The quay falls a little towards the water.
  const auto quay = [](double, double y) {
    return y < kEdge_m ? kWater_m : -0.004 * (140.0 - std::min(y, 140.0)) + 0.32;
  };
  World world(quay, {kLength_m, kDepth_m}, seed, {{}, {kEdge_m}});
  for (int block = 0; block < 4; ++block) {
    const auto number = static_cast<std::uint64_t>(1000 * block);
    if (block != static_cast<int>(4.0 * noise.uniform(7))) {  // one yard is empty
      add_stack(world, {36.0 + 64.0 * block + noise.uniform(number + 1, -4.0, 4.0), 118.0}, 3, 7, noise,
                number + 10'000);
      add_stack(world, {36.0 + 64.0 * block + noise.uniform(number + 2, -4.0, 4.0), 172.0}, 3, 5, noise,
                number + 20'000);
    }
  }
  add_crane(world, noise.uniform(21, 70.0, 95.0), noise, 30);
  add_crane(world, noise.uniform(22, 190.0, 250.0), noise, 40);
  for (double x = 12.0; x < kLength_m - 10.0; x += 20.0) {  // bollards
    world.add(Cylinder{{x, kEdge_m + 1.2}, 0.28, -0.2, 0.75, 0.4F});
  }
  for (double x = 40.0; x < kLength_m; x += 64.0) {  // light masts
    world.add(Cylinder{{x - 14.0, 160.0}, 0.35, 0.0, 30.0, 0.5F});
    add_block(world, {x - 15.2, 158.8, 0.0}, {x - 12.8, 161.2, 1.0}, 0.5F);
  }
  add_block(world, {90.0, 22.0, kWater_m}, {230.0, 52.0, 7.0}, 0.4F);      // a ship
  add_block(world, {205.0, 27.0, 7.0}, {225.0, 47.0, 21.0}, 0.6F);        // its bridge
  add_block(world, {4.0, 214.0, 0.0}, {70.0, 236.0, 9.0}, 0.45F);         // a shed
  for (double y = 100.0; y < 210.0; y += 4.0) {                            // a fence at the eastern end
    world.add(Cylinder{{kLength_m - 8.0, y}, 0.04, 0.0, 2.2, 0.5F});
  }
  Route route;
  route.bend_m = 5.0;
  route.floor = [quay](double x, double y) { return quay(x, std::max(y, kEdge_m)); };
  const double lanes[] = {92.0, 146.0};
  route.corners = {{24, lanes[0]},  {151, lanes[0]}, {292, lanes[0]}, {294, lanes[1]}, {151, lanes[1]},
                   {24, lanes[1]},  {24, lanes[0]},  {151, lanes[0]}, {151, lanes[1]}, {294, lanes[1]},
                   {292, lanes[0]}, {151, lanes[0]}, {151, lanes[1]}, {24, lanes[1]},  {24, lanes[0]}};
  add_traffic(world, route.corners, extras, noise);
  world.build();
  return {std::move(world), std::move(route), seed};
}

}  // namespace slamd::simulate
