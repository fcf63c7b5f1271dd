#include <algorithm>
#include <cmath>

#include "tools/loopnet/place_world.hpp"
#include "tools/simulate/masonry.hpp"

namespace slamd::loopnet {

namespace {

using simulate::Gap;
using simulate::Noise;
using simulate::Wall;

/// Lines at uneven distances.
std::vector<double> lines(const Noise& noise, std::uint64_t stream, double from, double low_m, double high_m, std::size_t count) {
  std::vector<double> at{from};
  while (at.size() < count) {
    at.push_back(at.back() + noise.uniform(stream + at.size(), low_m, high_m));
  }
  return at;
}

/// One floor of a building: corridors that cross, rooms between them, some halls, and what stands there.
class FloorBuilder {
 public:
  FloorBuilder(std::uint64_t seed, const Noise& noise)
      : noise_(noise),
        ceiling_m_(noise.uniform(1, 2.3, 4.5)),
        half_m_(0.5 * noise.uniform(2, 1.5, 3.6)),
        furniture_(noise.uniform(3, 0.15, 1.0)),
        xs_(lines(noise, 20, 8.0, 13.0, 34.0, 3 + static_cast<std::size_t>(2.0 * noise.uniform(4)))),
        ys_(lines(noise, 40, 8.0, 11.0, 30.0, 2 + static_cast<std::size_t>(2.0 * noise.uniform(5)))),
        floor_{{[](double, double) { return 0.0; }, {xs_.back() + 8.0, ys_.back() + 8.0}, seed, {}, 8.0},
               {},
               [](double, double) { return 0.0; },
               true} {}

  PlaceWorld build() {
    const double width = xs_.back() + 8.0;
    const double depth = ys_.back() + 8.0;
    simulate::add_block(floor_.world, {0.0, 0.0, ceiling_m_}, {width, depth, ceiling_m_ + 0.3}, 0.7F);
    for (const double x : {0.4, width - 0.4}) {
      add_wall(floor_.world, {false, x, 0.4, depth - 0.4, 0.0, ceiling_m_, 0.3, 0.6F, 0.0F}, {});
    }
    for (const double y : {0.4, depth - 0.4}) {
      add_wall(floor_.world, {true, y, 0.4, width - 0.4, 0.0, ceiling_m_, 0.3, 0.6F, 0.0F}, {});
    }
    for (std::size_t column = 0; column <= xs_.size(); ++column) {
      for (std::size_t row = 0; row <= ys_.size(); ++row) {
        const double west = column == 0 ? 0.55 : xs_[column - 1] + half_m_;
        const double east = column == xs_.size() ? width - 0.55 : xs_[column] - half_m_;
        const double south = row == 0 ? 0.55 : ys_[row - 1] + half_m_;
        const double north = row == ys_.size() ? depth - 0.55 : ys_[row] - half_m_;
        add_block_of_rooms({west, south}, {east, north}, row > 0, row < ys_.size(), column > 0, column < xs_.size());
      }
    }
    for (const double x : xs_) {
      floor_.lanes.push_back({{x, ys_.front()}, {x, ys_.back()}});
    }
    for (const double y : ys_) {
      floor_.lanes.push_back({{xs_.front(), y}, {xs_.back(), y}});
    }
    add_corridor_things();
    add_passers_by(floor_, noise_, 0, 10);
    floor_.world.build();
    return std::move(floor_);
  }

 private:
  double uniform(double low, double high) { return noise_.uniform(++draws_ + 1000, low, high); }
  bool chance(double share) { return uniform(0.0, 1.0) < share; }

  /// The rooms of one block, with corridors on the sides named.
  void add_block_of_rooms(const Eigen::Vector2d& low, const Eigen::Vector2d& high, bool south, bool north, bool west, bool east) {
    const double kind = uniform(0.0, 1.0);
    if (kind < 0.1) {  // open: a hall with columns
      for (double x = low.x() + 2.0; x < high.x() - 1.0; x += uniform(3.0, 6.0)) {
        const double y = uniform(low.y() + 1.0, high.y() - 0.5);
        simulate::add_block(floor_.world, {x, y, 0.0}, {x + 0.4, y + 0.4, ceiling_m_}, 0.5F);
        if (chance(0.5)) {
          furniture_piece({x + 1.0, uniform(low.y() + 0.5, high.y() - 1.5)});
        }
      }
      return;
    }
    const bool two_rows = high.y() - low.y() > 8.0 && south && north;
    const double middle = two_rows ? uniform(low.y() + 3.5, high.y() - 3.5) : (north ? low.y() : high.y());
    if (two_rows) {
      add_wall(floor_.world, {true, middle, low.x(), high.x(), 0.0, ceiling_m_, 0.1, 0.65F, 0.0F}, {});
    }
    if (west) {
      add_wall(floor_.world, {false, low.x(), low.y(), high.y(), 0.0, ceiling_m_, 0.12, 0.65F, 0.0F}, side_doors(low.y(), high.y()));
    }
    if (east) {
      add_wall(floor_.world, {false, high.x(), low.y(), high.y(), 0.0, ceiling_m_, 0.12, 0.65F, 0.0F}, side_doors(low.y(), high.y()));
    }
    if (north) {
      add_row(low.x(), high.x(), high.y(), two_rows ? middle : low.y());
    }
    if (south) {
      add_row(low.x(), high.x(), low.y(), two_rows ? middle : high.y());
    }
  }

  std::vector<Gap> side_doors(double from, double to) {
    std::vector<Gap> gaps;
    for (double y = from + uniform(1.0, 5.0); y < to - 2.0; y += uniform(3.0, 12.0)) {
      if (chance(0.6)) {
        const double wide = uniform(0.8, 1.4);
        gaps.push_back({y, y + wide});
        if (chance(0.6)) {
          y += wide;
        }
      }
      y += 1.5;
    }
    return gaps;
  }

  /// Rooms with their doors in the wall `front`.
  void add_row(double from, double to, double front, double back) {
    const double inward = back > front ? 1.0 : -1.0;
    for (double x = from; x < to - 1.5;) {
      const double width = to - x < 5.0 ? to - x : std::min(uniform(2.5, 9.0), to - x);
      const double door_m = chance(0.15) ? 1.8 : uniform(0.8, 1.1);
      const double door = x + 0.3 + uniform(0.0, std::max(0.1, width - 0.6 - door_m));
      Wall wall{true, front, x, x + width, 0.0, ceiling_m_, 0.12, 0.65F, 0.0F};
      const std::vector<Gap> gap{{door, std::min(door + door_m, x + width - 0.05)}};
      if (chance(0.12)) {  // glass above a sill
        wall.top = uniform(0.2, 1.0);
        add_wall(floor_.world, wall, gap);
        wall.bottom = wall.top;
        wall.top = ceiling_m_;
        wall.thickness = 0.02;
        wall.transparency = 0.85F;
        add_wall(floor_.world, wall, gap);
      } else {
        add_wall(floor_.world, wall, gap);
        simulate::add_block(floor_.world, {gap[0].from, front - 0.06, 2.1}, {gap[0].to, front + 0.06, ceiling_m_}, 0.65F);
      }
      if (chance(0.45)) {  // the door is shut, in its frame
        const double set_back = 0.05 + 0.08 * uniform(0.0, 1.0);
        const double y = front + inward * set_back;
        simulate::add_block(floor_.world, {gap[0].from, y - 0.02, 0.0}, {gap[0].to, y + 0.02, 2.1}, 0.4F);
      }
      add_wall(floor_.world, {false, x + width, std::min(front, back), std::max(front, back), 0.0, ceiling_m_, 0.1, 0.65F, 0.0F}, {});
      const auto pieces = static_cast<int>(furniture_ * uniform(0.0, 1.0) * width);
      for (int i = 0; i < pieces; ++i) {
        const double deep = std::abs(back - front);
        furniture_piece({uniform(x + 0.2, std::max(x + 0.3, x + width - 1.4)),
                         std::min(front, back) + uniform(0.2, std::max(0.3, deep - 1.0))});
      }
      x += width;
    }
  }

  void furniture_piece(const Eigen::Vector2d& p) {
    const double wide = uniform(0.3, 1.5);
    const double deep = uniform(0.3, 0.9);
    const double height = uniform(0.4, 2.0);
    if (chance(0.5)) {
      simulate::add_block(floor_.world, {p.x(), p.y(), 0.0}, {p.x() + wide, p.y() + deep, height}, 0.5F);
    } else {  // a table: a plate on legs
      simulate::add_block(floor_.world, {p.x(), p.y(), 0.7}, {p.x() + wide, p.y() + deep, 0.75}, 0.5F);
      simulate::add_block(floor_.world, {p.x(), p.y(), 0.0}, {p.x() + 0.06, p.y() + deep, 0.7}, 0.5F);
      simulate::add_block(floor_.world, {p.x() + wide - 0.06, p.y(), 0.0}, {p.x() + wide, p.y() + deep, 0.7}, 0.5F);
    }
  }

  /// Pillars, cupboards, plants, boxes along the walls of the corridors.
  void add_corridor_things() {
    const double per_m = uniform(0.05, 0.45);
    for (std::size_t lane = 0; lane < floor_.lanes.size(); ++lane) {
      const Eigen::Vector2d a = floor_.lanes[lane][0];
      const Eigen::Vector2d b = floor_.lanes[lane][1];
      const Eigen::Vector2d ahead = (b - a).normalized();
      const Eigen::Vector2d left(-ahead.y(), ahead.x());
      for (double s = 1.5; s < (b - a).norm() - 1.5; s += 1.0) {
        if (!chance(per_m)) {
          continue;
        }
        const double side = chance(0.5) ? 1.0 : -1.0;
        const double deep = std::min(uniform(0.1, 0.45), 0.4 * half_m_);
        const Eigen::Vector2d p = a + (s + uniform(0.0, 1.0)) * ahead + side * (half_m_ - 0.5 * deep - 0.03) * left;
        if (chance(0.25)) {
          floor_.world.add(simulate::Cylinder{p, 0.5 * deep, 0.0, uniform(0.4, 1.2), 0.4F});
        } else {
          const double along = uniform(0.15, 0.7);
          const double height = chance(0.3) ? ceiling_m_ : uniform(0.5, 2.0);
          floor_.world.add(simulate::OrientedBox{{p.x(), p.y(), 0.5 * height},
                                                 {along, 0.5 * deep, 0.5 * height},
                                                 std::atan2(ahead.y(), ahead.x()),
                                                 0.5F});
        }
      }
    }
  }

  const Noise& noise_;
  double ceiling_m_;
  double half_m_;  // of a corridor
  double furniture_;
  std::vector<double> xs_;
  std::vector<double> ys_;
  PlaceWorld floor_;
  std::uint64_t draws_ = 0;
};

}  // namespace

/// Floors of buildings, no two with the same plan.
PlaceWorld make_floors(std::uint64_t seed) {
  const Noise noise(seed, 800);
  return FloorBuilder(seed, noise).build();
}

}  // namespace slamd::loopnet
