#include <algorithm>
#include <cmath>

#include "tools/simulate/scenery.hpp"
#include "tools/simulate/waves.hpp"

namespace slamd::simulate {

namespace {

constexpr double kPitch_m = 52.0;       // between streets
constexpr double kHalfRoad_m = 4.0;     // from the centre line to the kerb
constexpr double kSidewalk_m = 2.5;
constexpr double kKerb_m = 0.12;
constexpr int kStreets = 5;             // in each direction
constexpr double kMargin_m = 30.0;

std::vector<double> street_lines(const Noise& noise, std::uint64_t stream) {
  std::vector<double> lines;
  for (int i = 0; i < kStreets; ++i) {
    lines.push_back(kMargin_m + kPitch_m * i + noise.uniform(stream + static_cast<std::uint64_t>(i), -4.0, 4.0));
  }
  return lines;
}

double distance_to_nearest(const std::vector<double>& lines, double v) {
  double best = 1e9;
  for (const double line : lines) {
    best = std::min(best, std::abs(v - line));
  }
  return best;
}

/// Where the ground has its steps: on both sides of each street.
std::vector<double> kerbs(const std::vector<double>& lines) {
  std::vector<double> breaks;
  for (const double line : lines) {
    breaks.push_back(line - kHalfRoad_m);
    breaks.push_back(line + kHalfRoad_m);
  }
  return breaks;
}

/// Road, kerb and sidewalk.
double ground_height(const Waves& road, const std::vector<double>& xs, const std::vector<double>& ys, double x,
                     double y) {
  const bool on_road = distance_to_nearest(xs, x) < kHalfRoad_m || distance_to_nearest(ys, y) < kHalfRoad_m;
  return road.height(x, y) + (on_road ? 0.0 : kKerb_m);
}

class TownBuilder {
 public:
  explicit TownBuilder(std::uint64_t seed);

  Scenery build(std::uint64_t seed, const Extras& extras);

 private:
  void add_block(int column, int row);
  void add_building(const Eigen::Vector2d& centre, const Eigen::Vector2d& half, std::uint64_t index);
  void add_facade(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double top_m, double bottom_m,
                  std::uint64_t index);
  void add_street_side(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint64_t index);

  Noise noise_;
  std::vector<double> streets_x_;  // centre lines of the streets that run along y
  std::vector<double> streets_y_;
  Waves road_;
  World world_;
};

}  // namespace

TownBuilder::TownBuilder(std::uint64_t seed)
    : noise_(seed, 1),
      streets_x_(street_lines(noise_, 10)),
      streets_y_(street_lines(noise_, 20)),
      road_(noise_, 35.0, 120.0, 2.0 * M_PI * 0.0016),
      world_([road = road_, xs = streets_x_, ys = streets_y_](double x,
                                                              double y) { return ground_height(road, xs, ys, x, y); },
             {2.0 * kMargin_m + kPitch_m * (kStreets - 1), 2.0 * kMargin_m + kPitch_m * (kStreets - 1)}, seed,
             {kerbs(streets_x_), kerbs(streets_y_)}) {
  for (int column = -1; column < kStreets; ++column) {
    for (int row = -1; row < kStreets; ++row) {
      add_block(column, row);
    }
  }
}

Scenery TownBuilder::build(std::uint64_t seed, const Extras& extras) {
  // Corners of the tour as street numbers; it crosses and repeats itself in both directions before it closes.
  const std::vector<std::pair<std::size_t, std::size_t>> crossings{
      {1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {1, 3}, {3, 3}, {3, 2}, {2, 2}, {2, 1}, {3, 1}, {3, 2}, {1, 2}, {1, 1}};
  Route route;
  for (const auto& [x, y] : crossings) {
    route.corners.emplace_back(streets_x_[x], streets_y_[y]);
  }
  route.bend_m = 2.83;  // bends of some 4 m radius
  route.floor = [road = road_](double x, double y) { return road.height(x, y); };
  add_traffic(world_, route.corners, extras, noise_);
  world_.build();
  return {std::move(world_), std::move(route), seed};
}

void TownBuilder::add_block(int column, int row) {
  const double setback = kHalfRoad_m + kSidewalk_m;
  const auto edge = [&](const std::vector<double>& lines, int i, double extent) {
    return i < 0 ? 0.0 : (i >= kStreets ? extent : lines[static_cast<std::size_t>(i)] );
  };
  const double west = edge(streets_x_, column, world_.extent_m().x()) + (column < 0 ? 2.0 : setback);
  const double east = edge(streets_x_, column + 1, world_.extent_m().x()) - (column + 1 >= kStreets ? 2.0 : setback);
  const double south = edge(streets_y_, row, world_.extent_m().y()) + (row < 0 ? 2.0 : setback);
  const double north = edge(streets_y_, row + 1, world_.extent_m().y()) - (row + 1 >= kStreets ? 2.0 : setback);
  const auto index = static_cast<std::uint64_t>((column + 2) * 100 + row + 2) * 1000;
  // Houses along the southern and the northern street, with gaps, yards and different setbacks.
  for (int side = 0; side < 2; ++side) {
    std::uint64_t house = index + static_cast<std::uint64_t>(side) * 100;
    for (double x = west + noise_.uniform(house, 0.0, 3.0); x < east - 6.0; ++house) {
      const double width = std::min(noise_.uniform(house + 11, 7.0, 16.0), east - x);
      const double depth = std::min(noise_.uniform(house + 22, 8.0, 13.0), 0.45 * (north - south));
      const double back = noise_.uniform(house + 33, 0.0, 2.5);
      const double y = side == 0 ? south + back + 0.5 * depth : north - back - 0.5 * depth;
      add_building({x + 0.5 * width, y}, {0.5 * width, 0.5 * depth}, house);
      x += width + (noise_.uniform(house + 44) < 0.5 ? noise_.uniform(house + 55, 0.0, 0.3)
                                                     : noise_.uniform(house + 66, 2.0, 6.0));
    }
  }
  add_street_side({west, south - kSidewalk_m}, {east, south - kSidewalk_m}, index + 300);
  add_street_side({east, north + kSidewalk_m}, {west, north + kSidewalk_m}, index + 400);
  add_street_side({west - kSidewalk_m, north}, {west - kSidewalk_m, south}, index + 500);
  add_street_side({east + kSidewalk_m, south}, {east + kSidewalk_m, north}, index + 600);
  if (noise_.uniform(index + 700) < 0.6) {  // a garden fence closes the yard to the west
    const double z = world_.ground(west, 0.5 * (south + north)) + 0.6;
    world_.add(OrientedBox{{west + 0.3, 0.5 * (south + north), z}, {0.03, 0.2 * (north - south), 0.7}, 0.0, 0.35F});
  }
}

void TownBuilder::add_building(const Eigen::Vector2d& centre, const Eigen::Vector2d& half, std::uint64_t index) {
  const double ground = world_.ground(centre.x(), centre.y());
  const double height = noise_.uniform(index + 77, 4.0, 13.0);
  const Reflectivity reflectivity = static_cast<Reflectivity>(noise_.uniform(index + 78, 0.25, 0.7));
  world_.add(OrientedBox{{centre.x(), centre.y(), ground + 0.5 * height - 1.0},
                         {half.x(), half.y(), 0.5 * height + 1.0},
                         0.0,
                         reflectivity});
  const Eigen::Vector2d a = centre - half;
  const Eigen::Vector2d b = centre + half;
  add_facade({a.x(), a.y()}, {b.x(), a.y()}, ground + height, ground, index + 1'000'000);
  add_facade({b.x(), a.y()}, {b.x(), b.y()}, ground + height, ground, index + 2'000'000);
  add_facade({b.x(), b.y()}, {a.x(), b.y()}, ground + height, ground, index + 3'000'000);
  add_facade({a.x(), b.y()}, {a.x(), a.y()}, ground + height, ground, index + 4'000'000);
}

void TownBuilder::add_facade(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double top_m, double bottom_m,
                             std::uint64_t index) {
  const Eigen::Vector2d along = (to - from).normalized();
  const Eigen::Vector2d outward(along.y(), -along.x());
  const double yaw = std::atan2(along.y(), along.x());
  const double length = (to - from).norm();
  const double bay = noise_.uniform(index + 1, 2.2, 3.6);
  for (int i = 0; (i + 0.5) * bay < length; ++i) {
    const auto item = index + 10 * static_cast<std::uint64_t>(i);
    const Eigen::Vector2d middle = from + (i + 0.5) * bay * along;
    // A pilaster between the bays, and sills and lintels that frame each window.
    const double depth = noise_.uniform(item + 2, 0.08, 0.3);
    const Eigen::Vector2d pilaster = from + i * bay * along + 0.5 * depth * outward;
    world_.add(OrientedBox{{pilaster.x(), pilaster.y(), 0.5 * (top_m + bottom_m)},
                           {0.2, 0.5 * depth, 0.5 * (top_m - bottom_m)},
                           yaw,
                           0.45F});
    for (double floor = bottom_m + 0.9; floor + 2.0 < top_m; floor += 3.0) {
      const Eigen::Vector2d sill = middle + 0.1 * outward;
      world_.add(OrientedBox{{sill.x(), sill.y(), floor}, {0.6, 0.1, 0.06}, yaw, 0.55F});
      world_.add(OrientedBox{{sill.x(), sill.y(), floor + 1.5}, {0.6, 0.1, 0.06}, yaw, 0.55F});
    }
    if (noise_.uniform(item + 3) < 0.12) {  // a porch or balcony
      const Eigen::Vector2d porch = middle + 0.6 * outward;
      world_.add(OrientedBox{{porch.x(), porch.y(), bottom_m + 2.6}, {0.9, 0.6, 0.1}, yaw, 0.4F});
      world_.add(OrientedBox{{porch.x(), porch.y(), bottom_m + 0.1}, {0.9, 0.6, 0.25}, yaw, 0.4F});
    }
  }
}

void TownBuilder::add_street_side(const Eigen::Vector2d& from, const Eigen::Vector2d& to, std::uint64_t index) {
  // `from`–`to` runs along the kerb, the road on its right.
  const Eigen::Vector2d along = (to - from).normalized();
  const Eigen::Vector2d to_road(along.y(), -along.x());
  const double yaw = std::atan2(along.y(), along.x());
  const double length = (to - from).norm();
  for (double s = 4.0; s < length - 4.0; s += 1.0, ++index) {
    const double draw = noise_.uniform(index * 7 + 5);
    const Eigen::Vector2d kerb = from + s * along;
    const double ground = world_.ground(kerb.x(), kerb.y());
    if (draw < 0.09) {  // a parked car: body and cabin
      const Eigen::Vector2d car = kerb + 1.05 * to_road;
      const double turn = yaw + noise_.uniform(index * 7 + 6, -0.04, 0.04);
      const double size = noise_.uniform(index * 7 + 1, 0.9, 1.15);
      world_.add(OrientedBox{{car.x(), car.y(), ground + 0.45}, {2.1 * size, 0.86, 0.38}, turn, 0.6F});
      world_.add(OrientedBox{{car.x(), car.y(), ground + 1.1}, {1.1 * size, 0.74, 0.33}, turn, 0.3F});
      s += 5.5;
    } else if (draw < 0.14) {  // a tree on the sidewalk
      const Eigen::Vector2d tree = kerb - 0.9 * to_road;
      const double trunk = noise_.uniform(index * 7 + 1, 2.0, 3.0);
      const double radius = noise_.uniform(index * 7 + 2, 1.1, 2.0);
      world_.add(
          Cylinder{tree, noise_.uniform(index * 7 + 3, 0.08, 0.2), ground - 0.5, ground + trunk + 0.5 * radius, 0.3F});
      world_.add(
          Crown{{tree.x(), tree.y(), ground + trunk + radius}, radius, noise_.uniform(index * 7 + 4, 0.7, 1.8), 0.25F});
      s += 3.0;
    } else if (draw < 0.19) {  // a lamp, or a sign
      const Eigen::Vector2d pole = kerb - 0.4 * to_road;
      world_.add(Cylinder{pole, noise_.uniform(index * 7 + 1, 0.04, 0.1), ground - 0.5,
                          ground + noise_.uniform(index * 7 + 2, 2.5, 6.0), 0.5F});
      if (draw > 0.17) {
        world_.add(OrientedBox{{pole.x(), pole.y(), ground + 2.3}, {0.35, 0.02, 0.25}, yaw + M_PI_2, 0.9F});
      }
      s += 2.0;
    }
  }
}

Scenery make_town(std::uint64_t seed, const Extras& extras) { return TownBuilder(seed).build(seed, extras); }

}  // namespace slamd::simulate
