#include <algorithm>
#include <cmath>

#include "tools/loopnet/place_world.hpp"
#include "tools/simulate/masonry.hpp"
#include "tools/simulate/waves.hpp"

namespace slamd::loopnet {

namespace {

using simulate::Crown;
using simulate::Cylinder;
using simulate::Noise;
using simulate::OrientedBox;

/// How one town differs from the next.
struct Style {
  double half_road_m;
  double sidewalk_m;
  double gap_share;       // of house fronts that leave a gap
  double low_m;           // heights of houses
  double high_m;
  double facade_m;        // depth of what stands out of a facade
  double cars_per_m;
  double trees_per_m;
  double poles_per_m;
};

Style style_of(const Noise& noise) {
  return {noise.uniform(1, 2.8, 6.5),  noise.uniform(2, 1.0, 4.0),   noise.uniform(3, 0.1, 0.8),
          noise.uniform(4, 3.0, 7.0),  noise.uniform(5, 8.0, 22.0),  noise.uniform(6, 0.0, 0.7),
          noise.uniform(7, 0.0, 0.12), noise.uniform(8, 0.0, 0.10),  noise.uniform(9, 0.01, 0.06)};
}

/// A growing number, so that each draw is new.
class Draw {
 public:
  Draw(const Noise& noise, std::uint64_t first) : noise_(noise), next_(first) {}
  double uniform(double low, double high) { return noise_.uniform(next_++, low, high); }
  bool chance(double share) { return noise_.uniform(next_++) < share; }

 private:
  const Noise& noise_;
  std::uint64_t next_;
};

/// A street's sides, from end to end: houses, then what stands on the pavement and along the kerb.
class StreetBuilder {
 public:
  StreetBuilder(simulate::World& world, const Style& style, Draw draw) : world_(world), style_(style), draw_(draw) {}

  void build(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    ahead_ = (to - from).normalized();
    yaw_rad_ = std::atan2(ahead_.y(), ahead_.x());
    const double length_m = (to - from).norm();
    for (const double side : {-1.0, 1.0}) {
      from_ = from;
      out_ = side * Eigen::Vector2d(ahead_.y(), -ahead_.x());
      if (draw_.chance(0.15)) {
        add_yard(length_m);
      } else {
        add_houses(length_m);
      }
      add_kerb(length_m);
    }
  }

 private:
  Eigen::Vector2d at(double along_m, double out_m) const { return from_ + along_m * ahead_ + out_m * out_; }

  void box(const Eigen::Vector2d& p, const Eigen::Vector3d& half, double above_m, double turn_rad = 0.0) {
    const double ground = world_.ground(p.x(), p.y());
    world_.add(OrientedBox{{p.x(), p.y(), ground + above_m + half.z()}, half, yaw_rad_ + turn_rad, 0.5F});
  }

  void tree(const Eigen::Vector2d& p) {
    simulate::add_tree(world_, p, draw_.uniform(1.5, 3.5), draw_.uniform(0.8, 3.0), draw_.uniform(0.5, 2.0));
  }

  void add_houses(double length_m) {
    const double edge_m = style_.half_road_m + style_.sidewalk_m;
    for (double s = draw_.uniform(0.0, 6.0); s < length_m - 4.0;) {
      const double width = std::min(draw_.uniform(5.0, 26.0), length_m - s);
      const double depth = draw_.uniform(5.0, 14.0);
      const double back = draw_.chance(0.4) ? draw_.uniform(0.0, 6.0) : draw_.uniform(0.0, 0.6);
      const double height = draw_.uniform(style_.low_m, style_.high_m);
      const double turn = draw_.chance(0.15) ? draw_.uniform(-0.35, 0.35) : 0.0;
      box(at(s + 0.5 * width, edge_m + back + 0.5 * depth + 3.0 * std::abs(turn)),
          {0.5 * width, 0.5 * depth, 0.5 * height + 1.0}, -2.0, turn);
      if (turn == 0.0 && style_.facade_m > 0.05) {
        add_facade(s, width, edge_m + back, height);
      }
      if (back > 2.0 && draw_.chance(0.6)) {  // a garden wall or hedge in front
        box(at(s + 0.5 * width, edge_m + 0.2), {0.5 * width, 0.15, 0.5 * draw_.uniform(0.6, 1.8)}, 0.0);
      }
      s += width + (draw_.chance(style_.gap_share) ? draw_.uniform(1.5, 14.0) : 0.0);
    }
  }

  void add_facade(double s, double width, double out_m, double height) {
    const double bay = draw_.uniform(1.8, 5.0);
    for (double a = s + 0.5 * bay; a < s + width; a += bay) {
      const double depth = draw_.uniform(0.2, 1.0) * style_.facade_m;
      if (draw_.chance(0.5)) {
        box(at(a, out_m - 0.5 * depth), {draw_.uniform(0.1, 0.5), 0.5 * depth, 0.5 * height}, 0.0);
      }
      if (draw_.chance(0.2)) {  // a balcony or porch
        box(at(a, out_m - 0.6), {draw_.uniform(0.6, 1.6), 0.6, 0.3}, draw_.uniform(0.0, 5.0));
      }
    }
  }

  /// A park, a car park or a building site: open, with things scattered.
  void add_yard(double length_m) {
    const double edge_m = style_.half_road_m + style_.sidewalk_m;
    const bool trees = draw_.chance(0.5);
    for (double s = 3.0; s < length_m - 3.0; s += draw_.uniform(2.0, 6.0)) {
      const Eigen::Vector2d p = at(s, edge_m + draw_.uniform(1.0, 22.0));
      if (trees) {
        tree(p);
      } else {
        box(p, {draw_.uniform(0.5, 2.5), draw_.uniform(0.4, 1.2), draw_.uniform(0.3, 1.4)}, 0.0, draw_.uniform(0.0, 1.6));
      }
    }
  }

  void add_kerb(double length_m) {
    for (double s = 2.0; s < length_m - 2.0; s += 1.0) {
      if (draw_.chance(style_.cars_per_m)) {
        const double size = draw_.uniform(0.85, 1.3);
        const double turn = draw_.uniform(-0.05, 0.05);
        const Eigen::Vector2d p = at(s + 2.2, style_.half_road_m - 0.2);
        box(p, {2.1 * size, 0.88, 0.4 * size}, 0.15, turn);
        box(p, {1.2 * size, 0.76, 0.35 * size}, 0.15 + 0.8 * size, turn);
        s += 5.0 * size;
      } else if (draw_.chance(style_.trees_per_m)) {
        tree(at(s, style_.half_road_m + 0.7));
        s += 2.0;
      } else if (draw_.chance(style_.poles_per_m)) {
        const Eigen::Vector2d p = at(s, style_.half_road_m + 0.4);
        const double ground = world_.ground(p.x(), p.y());
        world_.add(Cylinder{p, draw_.uniform(0.04, 0.2), ground - 0.5, ground + draw_.uniform(2.0, 8.0), 0.5F});
        if (draw_.chance(0.3)) {
          box(p, {0.03, draw_.uniform(0.2, 0.7), 0.3}, draw_.uniform(1.6, 2.4));
        }
      } else if (draw_.chance(0.02)) {  // a bin, a box, a bench
        box(at(s, style_.half_road_m + 0.8), {draw_.uniform(0.2, 0.9), 0.25, draw_.uniform(0.2, 0.7)}, 0.0);
      }
    }
  }

  simulate::World& world_;
  const Style& style_;
  Draw draw_;
  Eigen::Vector2d ahead_ = Eigen::Vector2d::UnitX();
  Eigen::Vector2d out_ = Eigen::Vector2d::UnitY();
  Eigen::Vector2d from_ = Eigen::Vector2d::Zero();
  double yaw_rad_ = 0.0;
};

}  // namespace

/// Streets that cross at uneven distances and odd angles, no two towns with the same plan, houses, trees or cars.
PlaceWorld make_streets(std::uint64_t seed) {
  const Noise noise(seed, 600);
  const Style style = style_of(noise);
  const simulate::Waves waves(noise, 60.0, 180.0, noise.uniform(10, 0.0, 0.012));
  const std::size_t across = 3 + static_cast<std::size_t>(3.0 * noise.uniform(11));
  const double pitch_m = noise.uniform(12, 45.0, 95.0);
  const double extent_m = 60.0 + pitch_m * static_cast<double>(across - 1);
  const auto height = [waves](double x, double y) { return waves.height(x, y); };
  PlaceWorld town{{height, {extent_m, extent_m}, seed, {}, 2.0}, {}, height, false};
  // Crossings, each moved on its own: streets bend there, blocks are no rectangles.
  std::vector<std::vector<Eigen::Vector2d>> crossing(across, std::vector<Eigen::Vector2d>(across));
  const double skew = noise.uniform(13, 0.0, 0.16) * pitch_m;
  for (std::size_t i = 0; i < across; ++i) {
    for (std::size_t j = 0; j < across; ++j) {
      const std::uint64_t number = 100 + 2 * (10 * i + j);
      crossing[i][j] = Eigen::Vector2d(30.0 + pitch_m * static_cast<double>(i) + noise.uniform(number, -skew, skew),
                                       30.0 + pitch_m * static_cast<double>(j) + noise.uniform(number + 1, -skew, skew));
    }
  }
  std::uint64_t street = 0;
  const auto add_street = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const std::uint64_t number = ++street * 100'000;
    if (noise.uniform(number) < 0.1) {
      return;  // there is none: a larger block
    }
    const double clear_m = style.half_road_m + style.sidewalk_m + 1.0;
    const Eigen::Vector2d ahead = (b - a).normalized();
    StreetBuilder(town.world, style, {noise, number + 1}).build(a + clear_m * ahead, b - clear_m * ahead);
    town.lanes.push_back({a, b});
  };
  for (std::size_t i = 0; i < across; ++i) {
    for (std::size_t j = 0; j < across; ++j) {
      if (i + 1 < across) {
        add_street(crossing[i][j], crossing[i + 1][j]);
      }
      if (j + 1 < across) {
        add_street(crossing[i][j], crossing[i][j + 1]);
      }
    }
  }
  add_passers_by(town, noise, 12, 8);
  town.world.build();
  return town;
}

}  // namespace slamd::loopnet
