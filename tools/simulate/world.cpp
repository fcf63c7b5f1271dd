#include "tools/simulate/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamd::simulate {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kGroundStep_m = 1.0;  // between tests of the ground along a ray
constexpr Reflectivity kGroundReflectivity = 0.3F;

}  // namespace

World::World(std::function<double(double, double)> ground, Eigen::Vector2d extent_m, std::uint64_t seed)
    : ground_(std::move(ground)), extent_m_(std::move(extent_m)), leaves_(seed, 77) {}

void World::add(const OrientedBox& box) {
  boxes_.push_back(box);
  turns_.push_back({std::cos(box.yaw_rad), std::sin(box.yaw_rad), box.half.head<2>().squaredNorm()});
  highest_m_ = std::max(highest_m_, box.centre.z() + box.half.z());
}

void World::add(const Cylinder& cylinder) {
  cylinders_.push_back(cylinder);
  highest_m_ = std::max(highest_m_, cylinder.top);
}

void World::add(const Crown& crown) {
  crowns_.push_back(crown);
  highest_m_ = std::max(highest_m_, crown.centre.z() + crown.radius);
}

void World::insert(Kind kind, std::uint32_t index, double x, double y, double radius) {
  const auto cell = [&](double v, int count) { return std::clamp(static_cast<int>(std::floor(v / kCell_m)), 0, count - 1); };
  for (int row = cell(y - radius, rows_); row <= cell(y + radius, rows_); ++row) {
    for (int column = cell(x - radius, columns_); column <= cell(x + radius, columns_); ++column) {
      cells_[static_cast<std::size_t>(row * columns_ + column)].push_back({kind, index});
    }
  }
}

void World::build() {
  columns_ = static_cast<int>(std::ceil(extent_m_.x() / kCell_m));
  rows_ = static_cast<int>(std::ceil(extent_m_.y() / kCell_m));
  // The ground is smooth but for kerbs: samples of half a metre, and a margin for what lies between.
  constexpr double kSample_m = 0.5;
  constexpr double kMargin_m = 0.05;
  cell_top_m_.assign(static_cast<std::size_t>(columns_ * rows_), -kNever);
  for (double y = 0.0; y <= rows_ * kCell_m; y += kSample_m) {
    for (double x = 0.0; x <= columns_ * kCell_m; x += kSample_m) {
      const double top = ground_(x, y) + kMargin_m;
      highest_m_ = std::max(highest_m_, top);
      // A sample on a border counts for both sides.
      for (const double dx : {-1e-6, 1e-6}) {
        for (const double dy : {-1e-6, 1e-6}) {
          const int column = std::clamp(static_cast<int>(std::floor((x + dx) / kCell_m)), 0, columns_ - 1);
          const int row = std::clamp(static_cast<int>(std::floor((y + dy) / kCell_m)), 0, rows_ - 1);
          double& cell_top = cell_top_m_[static_cast<std::size_t>(row * columns_ + column)];
          cell_top = std::max(cell_top, top);
        }
      }
    }
  }
  cells_.assign(static_cast<std::size_t>(columns_ * rows_), {});
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    const OrientedBox& box = boxes_[i];
    const double c = std::abs(std::cos(box.yaw_rad));
    const double s = std::abs(std::sin(box.yaw_rad));
    const double reach = std::max(c * box.half.x() + s * box.half.y(), s * box.half.x() + c * box.half.y());
    insert(Kind::kBox, i, box.centre.x(), box.centre.y(), reach);
  }
  for (std::uint32_t i = 0; i < cylinders_.size(); ++i) {
    insert(Kind::kCylinder, i, cylinders_[i].centre.x(), cylinders_[i].centre.y(), cylinders_[i].radius);
  }
  for (std::uint32_t i = 0; i < crowns_.size(); ++i) {
    insert(Kind::kCrown, i, crowns_[i].centre.x(), crowns_[i].centre.y(), crowns_[i].radius);
  }
}

void World::try_item(const Item& item, const Ray& ray, Hit& best) const {
  switch (item.kind) {
    case Kind::kBox: try_box(boxes_[item.index], turns_[item.index], ray, best); break;
    case Kind::kCylinder: try_cylinder(cylinders_[item.index], ray, best); break;
    case Kind::kCrown: try_crown(crowns_[item.index], item.index, ray, best); break;
  }
}

void World::try_box(const OrientedBox& box, const Turn& turn, const Ray& ray, Hit& best) const {
  const double c = turn.cosine;
  const double s = turn.sine;
  const Eigen::Vector3d offset = ray.origin - box.centre;
  const double miss = offset.x() * ray.direction.y() - offset.y() * ray.direction.x();
  if (miss * miss > turn.radius_sq) {
    return;  // the ray passes the circle around the box (its direction is at most 1 long in the plan)
  }
  const double origin[3] = {c * offset.x() + s * offset.y(), -s * offset.x() + c * offset.y(), offset.z()};
  const double direction[3] = {c * ray.direction.x() + s * ray.direction.y(),
                               -s * ray.direction.x() + c * ray.direction.y(), ray.direction.z()};
  double enter = 0.0;
  double leave = best.range_m;
  int face = -1;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-12) {
      if (std::abs(origin[axis]) > box.half[axis]) {
        return;
      }
      continue;
    }
    const double inverse = 1.0 / direction[axis];
    double a = (-box.half[axis] - origin[axis]) * inverse;
    double b = (box.half[axis] - origin[axis]) * inverse;
    if (a > b) {
      std::swap(a, b);
    }
    if (a > enter) {
      enter = a;
      face = axis;
    }
    leave = std::min(leave, b);
    if (enter > leave) {
      return;
    }
  }
  if (face >= 0 && enter < best.range_m) {
    best = {enter, std::abs(direction[face]), box.reflectivity};
  }
}

void World::try_cylinder(const Cylinder& cylinder, const Ray& ray, Hit& best) const {
  const Eigen::Vector2d o = ray.origin.head<2>() - cylinder.centre;
  const Eigen::Vector2d d = ray.direction.head<2>();
  const double a = d.squaredNorm();
  const double b = o.dot(d);
  const double discriminant = b * b - a * (o.squaredNorm() - cylinder.radius * cylinder.radius);
  if (a < 1e-12 || discriminant < 0.0) {
    return;
  }
  const double t = (-b - std::sqrt(discriminant)) / a;
  const double z = ray.origin.z() + t * ray.direction.z();
  if (t > 0.0 && t < best.range_m && z >= cylinder.bottom && z <= cylinder.top) {
    const double across = std::abs((o + t * d).dot(d)) / cylinder.radius;
    best = {t, across, cylinder.reflectivity};
  }
}

void World::try_crown(const Crown& crown, std::uint32_t index, const Ray& ray, Hit& best) const {
  const Eigen::Vector3d o = ray.origin - crown.centre;
  const double b = o.dot(ray.direction);
  const double discriminant = b * b - o.squaredNorm() + crown.radius * crown.radius;
  if (discriminant < 0.0) {
    return;
  }
  const double root = std::sqrt(discriminant);
  const double enter = std::max(0.0, -b - root);
  const double leave = -b + root;
  // How far the ray gets among the leaves: exponential, and its own for each ray and tree.
  const double depth = -crown.free_path_m * std::log(1.0 - leaves_.uniform(ray.number * 131 + index));
  const double t = enter + depth;
  if (t < leave && t < best.range_m) {
    best = {t, 0.7, crown.reflectivity};
  }
}

void World::try_ground(const Ray& ray, double from, double to, Hit& best) const {
  const auto above = [&](double t) {
    const Eigen::Vector3d p = ray.origin + t * ray.direction;
    return p.z() - ground_(p.x(), p.y());
  };
  double low = from;
  double height = above(low);
  while (low < to) {
    const double high = std::min(low + kGroundStep_m, to);
    const double next = above(high);
    if (height >= 0.0 && next < 0.0) {
      // Regula falsi with halving (Illinois): a few steps on smooth ground, and safe at a kerb.
      double a = low;
      double b = high;
      double f_a = height;
      double f_b = next;
      for (int i = 0; i < 60 && b - a > 1e-6 && f_b < -1e-7; ++i) {
        const double middle = i % 8 == 7 ? 0.5 * (a + b) : a + (b - a) * f_a / (f_a - f_b);
        const double f = above(middle);
        if (f >= 0.0) {
          a = middle;
          f_a = f;
          f_b *= 0.5;
        } else {
          b = middle;
          f_b = f;
          f_a *= 0.5;
        }
        if (f >= 0.0 && f < 1e-7) {
          b = middle;
          break;
        }
      }
      if (b < best.range_m) {
        const Eigen::Vector3d p = ray.origin + b * ray.direction;
        constexpr double kStep = 0.02;
        const double dx = (ground_(p.x() + kStep, p.y()) - ground_(p.x() - kStep, p.y())) / (2.0 * kStep);
        const double dy = (ground_(p.x(), p.y() + kStep) - ground_(p.x(), p.y() - kStep)) / (2.0 * kStep);
        const Eigen::Vector3d normal = Eigen::Vector3d(-dx, -dy, 1.0).normalized();
        best = {b, std::abs(normal.dot(ray.direction)), kGroundReflectivity};
      }
      return;
    }
    low = high;
    height = next;
  }
}

bool World::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                 std::uint64_t number, Hit& hit) const {
  const Ray ray{origin, direction, number};
  hit.range_m = max_range_m;
  // Amanatides and Woo: cell by cell along the ray, until a hit lies before the next border.
  const int step_x = direction.x() > 0.0 ? 1 : -1;
  const int step_y = direction.y() > 0.0 ? 1 : -1;
  int column = static_cast<int>(std::floor(origin.x() / kCell_m));
  int row = static_cast<int>(std::floor(origin.y() / kCell_m));
  const auto border = [&](int cell, int step, double o, double d) {
    return std::abs(d) < 1e-12 ? kNever : ((cell + (step > 0 ? 1 : 0)) * kCell_m - o) / d;
  };
  double next_x = border(column, step_x, origin.x(), direction.x());
  double next_y = border(row, step_y, origin.y(), direction.y());
  const double delta_x = std::abs(direction.x()) < 1e-12 ? kNever : kCell_m / std::abs(direction.x());
  const double delta_y = std::abs(direction.y()) < 1e-12 ? kNever : kCell_m / std::abs(direction.y());
  double from = 0.0;
  while (column >= 0 && row >= 0 && column < columns_ && row < rows_ && from < hit.range_m) {
    const double to = std::min(std::min(next_x, next_y), hit.range_m);
    for (const Item& item : cells_[static_cast<std::size_t>(row * columns_ + column)]) {
      try_item(item, ray, hit);
    }
    const double lowest = std::min(origin.z() + from * direction.z(), origin.z() + to * direction.z());
    if (lowest < cell_top_m_[static_cast<std::size_t>(row * columns_ + column)]) {
      try_ground(ray, from, std::min(to, hit.range_m), hit);
    }
    if (hit.range_m <= to || (direction.z() > 0.0 && origin.z() + to * direction.z() > highest_m_)) {
      break;
    }
    from = to;
    (next_x < next_y ? column : row) += next_x < next_y ? step_x : step_y;
    (next_x < next_y ? next_x : next_y) += next_x < next_y ? delta_x : delta_y;
  }
  return hit.range_m < max_range_m;
}

bool World::cast_brute_force(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range_m,
                             std::uint64_t number, Hit& hit) const {
  const Ray ray{origin, direction, number};
  hit.range_m = max_range_m;
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    try_item({Kind::kBox, i}, ray, hit);
  }
  for (std::uint32_t i = 0; i < cylinders_.size(); ++i) {
    try_item({Kind::kCylinder, i}, ray, hit);
  }
  for (std::uint32_t i = 0; i < crowns_.size(); ++i) {
    try_item({Kind::kCrown, i}, ray, hit);
  }
  double end = hit.range_m;
  for (int axis = 0; axis < 2; ++axis) {
    const double wall = direction[axis] > 0.0 ? (extent_m_[axis] - origin[axis]) / direction[axis]
                                              : (direction[axis] < 0.0 ? -origin[axis] / direction[axis] : kNever);
    end = std::min(end, wall);
  }
  try_ground(ray, 0.0, end, hit);
  return hit.range_m < max_range_m;
}

}  // namespace slamd::simulate
