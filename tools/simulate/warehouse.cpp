#include <cmath>

#include "tools/simulate/masonry.hpp"
#include "tools/simulate/scenery.hpp"

namespace slamd::simulate {

namespace {

constexpr double kLength_m = 84.0;
constexpr double kWidth_m = 56.0;
constexpr double kRoof_m = 9.0;
constexpr double kAisle_m = 3.4;
constexpr double kRack_m = 1.1;   // deep
constexpr double kBay_m = 2.8;    // between uprights
constexpr double kLevel_m = 1.9;  // between shelves
constexpr int kLevels = 4;
constexpr double kRackFrom_m = 10.0;
constexpr double kRackTo_m = kLength_m - 10.0;
constexpr int kRows = 9;

double row_at(int row) { return 6.0 + row * (kAisle_m + 2.0 * kRack_m); }

/// One rack: every bay is like the next; some pallets are missing.
void add_rack(World& world, double y, const Noise& noise, std::uint64_t index) {
  for (double x = kRackFrom_m; x <= kRackTo_m + 0.1; x += kBay_m) {
    for (const double side : {0.0, kRack_m - 0.1}) {
      add_block(world, {x - 0.05, y + side, 0.0}, {x + 0.05, y + side + 0.1, kLevels * kLevel_m}, 0.5F);
    }
  }
  for (int level = 0; level < kLevels; ++level) {
    const double z = level * kLevel_m;
    for (const double side : {0.0, kRack_m - 0.08}) {
      if (level > 0) {
        add_block(world, {kRackFrom_m, y + side, z - 0.12}, {kRackTo_m, y + side + 0.08, z}, 0.6F);
      }
    }
    for (double x = kRackFrom_m + 0.1; x + kBay_m <= kRackTo_m + 0.1; x += kBay_m) {
      for (int place = 0; place < 2; ++place, ++index) {
        if (noise.uniform(index) < 0.22) {
          continue;
        }
        const double x0 = x + 0.08 + place * 1.3;
        add_block(world, {x0, y + 0.08, z + 0.14}, {x0 + 1.2, y + kRack_m - 0.08, z + 1.5}, 0.45F);
        add_block(world, {x0, y + 0.08, z}, {x0 + 1.2, y + kRack_m - 0.08, z + 0.04}, 0.35F);
      }
    }
  }
}

}  // namespace

Scenery make_warehouse(std::uint64_t seed, const Extras& extras) {
  const Noise noise(seed, 400);
  World world([](double, double) { return 0.0; }, {kLength_m, kWidth_m}, seed);
  add_block(world, {0.0, 0.0, kRoof_m}, {kLength_m, kWidth_m, kRoof_m + 0.4}, 0.5F);
  for (double x = 6.0; x < kLength_m; x += 12.0) {  // girders under the roof
    add_block(world, {x, 0.0, kRoof_m - 0.6}, {x + 0.25, kWidth_m, kRoof_m}, 0.5F);
  }
  const std::vector<Gap> gates{{14.0, 18.0}, {34.0, 38.0}};
  for (const double x : {0.5, kLength_m - 0.5}) {
    add_wall(world, {false, x, 0.5, kWidth_m - 0.5, 0.0, kRoof_m, 0.3, 0.5F, 0.0F},
             x < 1.0 ? gates : std::vector<Gap>{});
  }
  for (const double y : {0.5, kWidth_m - 0.5}) {
    add_wall(world, {true, y, 0.5, kLength_m - 0.5, 0.0, kRoof_m, 0.3, 0.5F, 0.0F}, {});
    for (double x = 6.0; x < kLength_m - 2.0; x += 12.0) {  // columns
      add_block(world, {x, y - 0.35, 0.0}, {x + 0.35, y + 0.35, kRoof_m}, 0.5F);
    }
  }
  for (int row = 0; row < kRows; ++row) {
    add_rack(world, row_at(row), noise, 10'000 + 1000 * static_cast<std::uint64_t>(row));
    if (row > 0 && row + 1 < kRows) {  // racks stand back to back
      add_rack(world, row_at(row) + kRack_m, noise, 50'000 + 1000 * static_cast<std::uint64_t>(row));
    }
  }
  // A few pallets that somebody left at the ends of the aisles.
  for (std::uint64_t i = 0; i < 14; ++i) {
    const double x =
        noise.uniform(90 + i) < 0.5 ? noise.uniform(110 + i, 1.2, 3.2) : kLength_m - noise.uniform(110 + i, 2.4, 4.4);
    const double y = noise.uniform(130 + i, 4.0, kWidth_m - 6.0);
    add_block(world, {x, y, 0.0}, {x + 1.2, y + 0.8, noise.uniform(150 + i, 0.15, 1.6)}, 0.45F);
  }
  // Up one aisle and down another: they all look alike.
  Route route;
  route.bend_m = 0.8;
  route.floor = [](double, double) { return 0.0; };
  const auto aisle = [](int i) { return row_at(i) + 2.0 * kRack_m + 0.5 * kAisle_m; };
  const double west = 6.5;
  const double east = kLength_m - 6.5;
  for (const int i : {1, 3, 2, 5, 4, 2}) {
    const bool at_west = route.corners.empty() || route.corners.back().x() < 0.5 * kLength_m;
    route.corners.emplace_back(at_west ? west : east, aisle(i));
    route.corners.emplace_back(at_west ? east : west, aisle(i));
  }
  // The last aisle again, the other way round, and home.
  route.corners.push_back(route.corners.front());
  Extras people = extras;
  people.cars = 0;
  add_traffic(world, route.corners, people, noise);
  world.build();
  return {std::move(world), std::move(route), seed};
}

}  // namespace slamd::simulate
