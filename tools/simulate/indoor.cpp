#include <cmath>

#include "tools/simulate/masonry.hpp"
#include "tools/simulate/scenery.hpp"

namespace slamd::simulate {

namespace {

constexpr double kWidth_m = 64.0;
constexpr double kDepth_m = 44.0;
constexpr double kCeiling_m = 2.8;
constexpr double kCorridor_m = 2.4;
constexpr double kDoor_m = 1.0;

/// The middles of the corridors.
constexpr double kAcross_m[] = {9.0, 32.0, 55.0};  // along y
constexpr double kAlong_m[] = {9.0, 35.0};         // along x

/// One room: its walls inside, and the side of its door.
struct Room {
  double west;
  double east;
  double south;
  double north;
  bool door_north;
};

/// Desks, shelves and cupboards along the walls.
void furnish(World& world, const Room& room, const Noise& noise, std::uint64_t index) {
  for (double x = room.west + 0.3; x < room.east - 1.4; x += 1.6, index += 5) {
    const double draw = noise.uniform(index);
    const double depth = draw < 0.5 ? 0.38 : 0.75;
    const double height = draw < 0.5 ? noise.uniform(index + 1, 1.2, 2.1) : 0.74;
    // On the wall across from the door.
    const double y0 = room.door_north ? room.south : room.north - depth;
    if (draw < 0.5) {  // shelves: a back, sides and boards
      add_block(world, {x, y0, 0.0}, {x + 0.03, y0 + depth, height}, 0.45F);
      add_block(world, {x + 1.2, y0, 0.0}, {x + 1.23, y0 + depth, height}, 0.45F);
      for (double z = 0.1; z < height; z += 0.42) {
        add_block(world, {x, y0, z}, {x + 1.2, y0 + depth, z + 0.03}, 0.45F);
      }
    } else if (draw < 0.8) {  // a desk with a screen
      add_block(world, {x, y0, height - 0.04}, {x + 1.3, y0 + depth, height}, 0.5F);
      add_block(world, {x + 0.05, y0 + 0.05, 0.0}, {x + 0.1, y0 + depth - 0.05, height}, 0.5F);
      add_block(world, {x + 1.2, y0 + 0.05, 0.0}, {x + 1.25, y0 + depth - 0.05, height}, 0.5F);
      add_block(world, {x + 0.4, y0 + 0.3, height + 0.1}, {x + 0.95, y0 + 0.34, height + 0.45}, 0.1F);
    }
  }
}

/// A row of rooms on one side of a corridor along x, with a door each; some fronts are glass.
void add_rooms(World& world, double from, double to, double corridor, bool above, double back, const Noise& noise,
               std::uint64_t index) {
  const double front = corridor + (above ? 0.5 : -0.5) * kCorridor_m;
  for (double x = from; x < to - 2.0; index += 100) {
    double width = noise.uniform(index, 4.2, 7.5);
    if (to - x - width < 3.0) {
      width = to - x;
    }
    const double door = x + 0.6 + noise.uniform(index + 1) * (width - 2.0 - kDoor_m);
    const bool glass = noise.uniform(index + 2) < 0.3;
    Wall wall{true, front, x, x + width, 0.0, kCeiling_m, 0.12, 0.65F, 0.0F};
    if (glass) {
      wall.top = 0.3;
      add_wall(world, wall, {{door, door + kDoor_m}});
      Wall pane = wall;
      pane.bottom = 0.3;
      pane.top = kCeiling_m;
      pane.thickness = 0.02;
      pane.reflectivity = 0.15F;
      pane.transparency = 0.85F;
      add_wall(world, pane, {{door, door + kDoor_m}});
      add_block(world, {x - 0.05, front - 0.06, 0.0}, {x + 0.05, front + 0.06, kCeiling_m}, 0.6F);
    } else {
      add_wall(world, wall, {{door, door + kDoor_m}});
      add_block(world, {door, front - 0.06, 2.1}, {door + kDoor_m, front + 0.06, kCeiling_m}, 0.65F);
    }
    if (noise.uniform(index + 3) < 0.45) {  // shut
      add_block(world, {door, front - 0.02, 0.0}, {door + kDoor_m, front + 0.02, 2.1}, 0.4F);
    } else {  // open into the room
      const double inside = above ? front + 0.5 : front - 0.5;
      world.add(OrientedBox{{door + 0.02, inside, 1.05}, {0.02, 0.5, 1.05}, 0.0, 0.4F});
    }
    add_wall(world, {false, x + width, std::min(front, back), std::max(front, back), 0.0, kCeiling_m, 0.1, 0.7F, 0.0F},
             {});
    furnish(world, {x + 0.1, x + width - 0.1, std::min(front, back) + 0.1, std::max(front, back) - 0.1, !above}, noise,
            index + 10);
    x += width;
  }
}

/// What stands in corridors: fire extinguishers, door frames, a cupboard, a plant.
void add_corridor_things(World& world, const Noise& noise) {
  for (std::uint64_t i = 0; i < 26; ++i) {
    const double y = kAlong_m[i % 2] + (noise.uniform(700 + i) < 0.5 ? 1.0 : -1.0) * (0.5 * kCorridor_m - 0.12);
    const double x = noise.uniform(730 + i, 12.0, 52.0);
    if (std::abs(x - kAcross_m[1]) < 2.5) {
      continue;
    }
    const double draw = noise.uniform(760 + i);
    if (draw < 0.4) {
      world.add(Cylinder{{x, y}, 0.08, 0.6, 1.2, 0.5F});
    } else if (draw < 0.7) {
      add_block(world, {x, y - 0.1, 0.0}, {x + 0.9, y + 0.1, 1.1}, 0.5F);
    } else {
      world.add(Cylinder{{x, y}, 0.11, 0.0, 0.5, 0.4F});
      world.add(Crown{{x, y, 1.0}, 0.35, 0.5, 0.3F});
    }
  }
}

}  // namespace

Scenery make_indoor(std::uint64_t seed, const Extras& extras) {
  const Noise noise(seed, 200);
  World world([](double, double) { return 0.0; }, {kWidth_m, kDepth_m}, seed);
  add_block(world, {0.0, 0.0, kCeiling_m}, {kWidth_m, kDepth_m, kCeiling_m + 0.3}, 0.75F);
  // Outer walls.
  for (const double x : {0.5, kWidth_m - 0.5}) {
    add_wall(world, {false, x, 0.5, kDepth_m - 0.5, 0.0, kCeiling_m, 0.3, 0.6F, 0.0F}, {});
  }
  for (const double y : {0.5, kDepth_m - 0.5}) {
    add_wall(world, {true, y, 0.5, kWidth_m - 0.5, 0.0, kCeiling_m, 0.3, 0.6F, 0.0F}, {});
  }
  // Corridors along y have plain walls, broken where the others cross.
  const double half = 0.5 * kCorridor_m;
  const std::vector<Gap> crossings{{kAlong_m[0] - half, kAlong_m[0] + half}, {kAlong_m[1] - half, kAlong_m[1] + half}};
  for (const double x : kAcross_m) {
    for (const double side : {-half, half}) {
      const bool outer = (x == kAcross_m[0] && side < 0.0) || (x == kAcross_m[2] && side > 0.0);
      add_wall(world, {false, x + side, kAlong_m[0] - half, kAlong_m[1] + half, 0.0, kCeiling_m, 0.12, 0.65F, 0.0F},
               outer ? std::vector<Gap>{} : crossings);
      // Pillars, not evenly.
      for (double y = kAlong_m[0] + 3.0; y < kAlong_m[1] - 3.0;
           y += noise.uniform(static_cast<std::uint64_t>(100 * x + y + side), 3.5, 6.5)) {
        const double into = side > 0.0 ? -0.12 : 0.12;
        add_block(world, {x + side + std::min(into, 0.0), y, 0.0},
                  {x + side + std::max(into, 0.0), y + 0.35, kCeiling_m}, 0.55F);
      }
    }
  }
  for (std::size_t bay = 0; bay < 2; ++bay) {
    const double from = kAcross_m[bay] + half;
    const double to = kAcross_m[bay + 1] - half;
    add_rooms(world, from, to, kAlong_m[0], true, 15.5, noise, 10'000 + 5000 * bay);
    add_rooms(world, from, to, kAlong_m[1], false, 28.5, noise, 20'000 + 5000 * bay);
    add_wall(world, {true, 15.5, from, to, 0.0, kCeiling_m, 0.1, 0.7F, 0.0F}, {});
    add_wall(world, {true, 28.5, from, to, 0.0, kCeiling_m, 0.1, 0.7F, 0.0F}, {});
  }
  add_rooms(world, kAcross_m[0] - half, kAcross_m[2] + half, kAlong_m[0], false, 1.0, noise, 30'000);
  add_rooms(world, kAcross_m[0] - half, kAcross_m[2] + half, kAlong_m[1], true, kDepth_m - 1.0, noise, 40'000);
  add_corridor_things(world, noise);
  Route route;
  route.bend_m = 0.55;
  route.floor = [](double, double) { return 0.0; };
  const double x[] = {kAcross_m[0], kAcross_m[1], kAcross_m[2]};
  const double y[] = {kAlong_m[0], kAlong_m[1]};
  route.corners = {{x[0], y[0]}, {x[1], y[0]}, {x[1], y[1]}, {x[0], y[1]}, {x[0], y[0]}, {x[2], y[0]}, {x[2], y[1]},
                   {x[0], y[1]}, {x[0], y[0]}, {x[1], y[0]}, {x[1], y[1]}, {x[2], y[1]}, {x[2], y[0]},
                   {x[1], y[0]}, {x[1], y[1]}, {x[0], y[1]}, {x[0], y[0]}};
  Extras people = extras;
  people.cars = 0;
  add_traffic(world, route.corners, people, noise);
  world.build();
  return {std::move(world), std::move(route), seed};
}

}  // namespace slamd::simulate
