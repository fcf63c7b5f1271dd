#include <cmath>

#include "tools/simulate/masonry.hpp"
#include "tools/simulate/scenery.hpp"

namespace slamd::simulate {

namespace {

constexpr double kHalfWidth_m = 4.2;
constexpr double kWall_m = 2.2;  // upright, then the vault begins
constexpr double kStep_m = 2.0;
constexpr int kFaces = 14;       // of the vault

/// A line along the tunnel with a gentle bend one way and back.
class Axis {
 public:
  explicit Axis(const Noise& noise) : length_(noise.uniform(1, 220.0, 380.0)), swing_(noise.uniform(2, 5.0, 11.0)) {}

  double length() const { return length_; }
  double margin() const { return 18.0; }

  Eigen::Vector2d at(double s) const {
    return {margin() + s, 20.0 + swing_ * (1.0 - std::cos(2.0 * M_PI * s / length_)) * 0.5};
  }

  Eigen::Vector2d ahead(double s) const { return (at(s + 0.5) - at(s - 0.5)).normalized(); }

 private:
  double length_;
  double swing_;
};

/// A point of the lining: `turn` from 0 (right foot) to 1 (left foot).
Eigen::Vector3d lining(const Axis& axis, double s, double turn) {
  const Eigen::Vector2d p = axis.at(s);
  const Eigen::Vector2d ahead = axis.ahead(s);
  const Eigen::Vector2d right(ahead.y(), -ahead.x());
  if (turn <= 0.0 || turn >= 1.0) {
    const Eigen::Vector2d q = p + (turn <= 0.0 ? 1.0 : -1.0) * kHalfWidth_m * right;
    return {q.x(), q.y(), -0.1};
  }
  const double angle = M_PI * turn;
  const Eigen::Vector2d q = p + kHalfWidth_m * std::cos(angle) * right;
  return {q.x(), q.y(), kWall_m + 0.8 * kHalfWidth_m * std::sin(angle)};
}

void add_quad(World& world, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
  world.add(Triangle{{a.cast<float>(), b.cast<float>(), c.cast<float>()}, 0.35F});
  world.add(Triangle{{a.cast<float>(), c.cast<float>(), d.cast<float>()}, 0.35F});
}

void add_lining(World& world, const Axis& axis) {
  std::vector<double> turns{0.0};
  for (int i = 0; i <= kFaces; ++i) {
    turns.push_back(std::clamp(static_cast<double>(i) / kFaces, 1e-9, 1.0 - 1e-9));
  }
  turns.push_back(1.0);
  for (double s = 0.0; s < axis.length(); s += kStep_m) {
    for (std::size_t i = 0; i + 1 < turns.size(); ++i) {
      add_quad(world, lining(axis, s, turns[i]), lining(axis, s + kStep_m, turns[i]),
               lining(axis, s + kStep_m, turns[i + 1]), lining(axis, s, turns[i + 1]));
    }
  }
}

/// The little there is: lamps, cable ducts, a niche with a hydrant now and then, none of them evenly spaced.
void add_fittings(World& world, const Axis& axis, const Noise& noise) {
  std::uint64_t i = 0;
  for (double s = 9.0; s < axis.length() - 9.0; s += noise.uniform(100 + i, 17.0, 23.0), ++i) {
    const Eigen::Vector2d p = axis.at(s);
    const Eigen::Vector2d ahead = axis.ahead(s);
    const Eigen::Vector2d right(ahead.y(), -ahead.x());
    const double yaw = std::atan2(ahead.y(), ahead.x());
    world.add(OrientedBox{{p.x(), p.y(), 5.25}, {0.6, 0.12, 0.08}, yaw, 0.7F});
    if (i % 3 == 1) {
      const double side = noise.uniform(200 + i) < 0.5 ? 1.0 : -1.0;
      const Eigen::Vector2d q = p + side * (kHalfWidth_m - 0.2) * right;
      world.add(OrientedBox{{q.x(), q.y(), 1.1}, {noise.uniform(300 + i, 0.3, 0.8), 0.2, 0.9}, yaw, 0.55F});
    }
  }
  for (double s = 0.0; s < axis.length() - kStep_m; s += kStep_m) {
    const Eigen::Vector2d right(axis.ahead(s + 1.0).y(), -axis.ahead(s + 1.0).x());
    const Eigen::Vector2d q = axis.at(s + 1.0) + (kHalfWidth_m - 0.1) * right;
    const double yaw = std::atan2(axis.ahead(s + 1.0).y(), axis.ahead(s + 1.0).x());
    world.add(OrientedBox{{q.x(), q.y(), 1.9}, {1.01, 0.08, 0.1}, yaw, 0.4F});
  }
}

/// Rocks around both mouths.
void add_portal(World& world, const Axis& axis, double s, const Noise& noise, std::uint64_t index) {
  const Eigen::Vector2d p = axis.at(s);
  const Eigen::Vector2d ahead = axis.ahead(s);
  const Eigen::Vector2d right(ahead.y(), -ahead.x());
  const double yaw = std::atan2(ahead.y(), ahead.x());
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector2d q = p + side * (kHalfWidth_m + 2.6) * right;
    world.add(OrientedBox{{q.x(), q.y(), 3.5}, {0.5, 2.5, 4.0}, yaw, 0.3F});
    for (int i = 0; i < 3; ++i, ++index) {
      const double out = (s > 1.0 ? 1.0 : -1.0) * noise.uniform(index, 3.0, 13.0);
      const Eigen::Vector2d rock = p + out * ahead + side * noise.uniform(index + 50, 4.5, 8.0) * right;
      const double size = noise.uniform(index + 90, 0.4, 1.3);
      world.add(OrientedBox{{rock.x(), rock.y(), 0.5 * size},
                            {size, 0.8 * size, 0.6 * size},
                            noise.uniform(index + 130, 0.0, 3.0),
                            0.25F});
    }
  }
}

}  // namespace

Scenery make_tunnel(std::uint64_t seed, const Extras& extras) {
  const Noise noise(seed, 300);
  const Axis axis(noise);
  World world([](double, double) { return 0.0; }, {axis.length() + 2.0 * axis.margin(), 52.0}, seed);
  add_lining(world, axis);
  add_fittings(world, axis, noise);
  add_portal(world, axis, 0.0, noise, 600);
  add_portal(world, axis, axis.length(), noise, 900);
  // In on the right, round at the far mouth, and back on the left.
  Route route;
  route.bend_m = 1.2;
  route.floor = [](double, double) { return 0.0; };
  const auto lane = [&](double s, double right_m) {
    const Eigen::Vector2d ahead = axis.ahead(s);
    return Eigen::Vector2d(axis.at(s) + right_m * Eigen::Vector2d(ahead.y(), -ahead.x()));
  };
  const int pieces = 24;
  for (int i = 0; i <= pieces; ++i) {
    route.corners.push_back(lane(-6.0 + (axis.length() + 12.0) * i / pieces, 1.8));
  }
  for (int i = pieces; i >= 0; --i) {
    route.corners.push_back(lane(-6.0 + (axis.length() + 12.0) * i / pieces, -1.8));
  }
  route.corners.push_back(route.corners.front());
  Extras people = extras;
  people.cars = 0;
  add_traffic(world, route.corners, people, noise);
  world.build();
  return {std::move(world), std::move(route), seed};
}

}  // namespace slamd::simulate
