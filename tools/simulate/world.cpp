#include "tools/simulate/world.hpp"

#include <algorithm>
#include <cmath>

#include "tools/simulate/intersection.hpp"

namespace slamd::simulate {

namespace {

/// Moves things into the order in which `order` names them.
template <typename T>
void reorder(std::vector<T>& things, const std::vector<std::uint32_t>& order) {
  std::vector<T> sorted;
  sorted.reserve(things.size());
  for (const std::uint32_t index : order) {
    sorted.push_back(things[index]);
  }
  things.swap(sorted);
}

}  // namespace

World::World(const std::function<double(double, double)>& ground, Eigen::Vector2d extent_m, std::uint64_t seed,
             const HeightField::Breaks& breaks, double spacing_m)
    : ground_(ground, extent_m, spacing_m, breaks), extent_m_(std::move(extent_m)), leaves_(seed, 77) {}

void World::add(Mover mover) {
  double radius = 0.0;
  for (const OrientedBox& box : mover.boxes) {
    radius = std::max(radius, box.centre.head<2>().norm() + box.half.head<2>().norm());
  }
  mover.ground_m.clear();
  for (const Eigen::Vector2d& p : mover.path) {
    mover.ground_m.push_back(ground(p.x(), p.y()));
  }
  mover_radius_m_.push_back(radius);
  movers_.push_back(std::move(mover));
}

Bounds World::bounds_of(const Thing& thing) const {
  switch (thing.kind) {
    case Kind::kBox: {
      const OrientedBox& box = boxes_[thing.index];
      const double c = std::abs(std::cos(box.yaw_rad));
      const double s = std::abs(std::sin(box.yaw_rad));
      const Eigen::Vector3d reach(c * box.half.x() + s * box.half.y(), s * box.half.x() + c * box.half.y(),
                                  box.half.z());
      return {(box.centre - reach).cast<float>(), (box.centre + reach).cast<float>()};
    }
    case Kind::kCylinder: {
      const Cylinder& c = cylinders_[thing.index];
      return {Eigen::Vector3d(c.centre.x() - c.radius, c.centre.y() - c.radius, c.bottom).cast<float>(),
              Eigen::Vector3d(c.centre.x() + c.radius, c.centre.y() + c.radius, c.top).cast<float>()};
    }
    case Kind::kCrown: {
      const Crown& crown = crowns_[thing.index];
      return {(crown.centre.array() - crown.radius).cast<float>(), (crown.centre.array() + crown.radius).cast<float>()};
    }
    case Kind::kTriangle: break;
  }
  const Triangle& t = triangles_[thing.index];
  return {t.corners[0].cwiseMin(t.corners[1]).cwiseMin(t.corners[2]),
          t.corners[0].cwiseMax(t.corners[1]).cwiseMax(t.corners[2])};
}

void World::build() {
  things_.clear();
  const auto list = [&](Kind kind, std::size_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      things_.push_back({kind, i});
    }
  };
  list(Kind::kBox, boxes_.size());
  list(Kind::kCylinder, cylinders_.size());
  list(Kind::kCrown, crowns_.size());
  list(Kind::kTriangle, triangles_.size());
  std::vector<Bounds> bounds;
  bounds.reserve(things_.size());
  for (const Thing& thing : things_) {
    bounds.push_back(bounds_of(thing));
  }
  tree_.build(bounds);
  sort_things();
  turns_.clear();
  for (const OrientedBox& box : boxes_) {
    turns_.emplace_back(std::cos(box.yaw_rad), std::sin(box.yaw_rad));
  }
}

/// Lays boxes and triangles out in the order of the tree's leaves: a ray that meets one meets its neighbours next.
void World::sort_things() {
  std::vector<std::uint32_t> boxes;
  std::vector<std::uint32_t> triangles;
  for (const std::uint32_t thing : tree_.order()) {
    if (things_[thing].kind == Kind::kBox) {
      const auto place = static_cast<std::uint32_t>(boxes.size());
      boxes.push_back(things_[thing].index);
      things_[thing].index = place;
    } else if (things_[thing].kind == Kind::kTriangle) {
      const auto place = static_cast<std::uint32_t>(triangles.size());
      triangles.push_back(things_[thing].index);
      things_[thing].index = place;
    }
  }
  reorder(boxes_, boxes);
  reorder(triangles_, triangles);
}

void World::try_thing(std::uint32_t index, const Ray& ray, Hit& best) const {
  const Thing& thing = things_[index];
  switch (thing.kind) {
    case Kind::kBox: {
      const OrientedBox& box = boxes_[thing.index];
      Hit hit = best;
      if (intersect(box, turns_[thing.index], ray, hit) &&
          (box.transparency <= 0.0F ||
           leaves_.uniform(ray.number * 137 + thing.index) >= static_cast<double>(box.transparency))) {
        best = hit;
      }
      break;
    }
    case Kind::kCylinder: intersect(cylinders_[thing.index], ray, best); break;
    case Kind::kCrown: intersect(crowns_[thing.index], thing.index, leaves_, ray, best); break;
    case Kind::kTriangle: intersect(triangles_[thing.index], ray, best); break;
  }
}

void World::try_movers(const Ray& ray, double t_s, Hit& best) const {
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const MoverPlace place = place_of(movers_[i], t_s);
    const Eigen::Vector3d offset = ray.origin - place.position;
    const double miss = offset.x() * ray.direction.y() - offset.y() * ray.direction.x();
    if (miss * miss > mover_radius_m_[i] * mover_radius_m_[i]) {
      continue;  // the ray passes the circle around it (its direction is at most 1 long in the plan)
    }
    const double c = std::cos(place.yaw_rad);
    const double s = std::sin(place.yaw_rad);
    for (OrientedBox box : movers_[i].boxes) {
      box.centre = place.position + Eigen::Vector3d(c * box.centre.x() - s * box.centre.y(),
                                                    s * box.centre.x() + c * box.centre.y(), box.centre.z());
      intersect(box, {c, s}, ray, best);
    }
  }
}

bool World::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                 std::uint64_t number, Hit& hit, double t_s) const {
  const Ray ray{origin, direction, number};
  hit.range_m = max_range_m;
  ground_.cast(ray, hit);
  tree_.visit(ray, hit.range_m, [&](std::uint32_t thing) { try_thing(thing, ray, hit); });
  if (t_s >= 0.0) {
    try_movers(ray, t_s, hit);
  }
  return hit.range_m < max_range_m;
}

bool World::cast_brute_force(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                             std::uint64_t number, Hit& hit, double t_s) const {
  const Ray ray{origin, direction, number};
  hit.range_m = max_range_m;
  for (std::uint32_t thing = 0; thing < things_.size(); ++thing) {
    try_thing(thing, ray, hit);
  }
  ground_.cast_brute_force(ray, hit);
  if (t_s >= 0.0) {
    try_movers(ray, t_s, hit);
  }
  return hit.range_m < max_range_m;
}

}  // namespace slamd::simulate
