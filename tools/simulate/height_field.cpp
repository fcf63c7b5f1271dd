#include "tools/simulate/height_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slamd::simulate {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kHalfStep_m = 0.005;  // a step rises over a centimetre
constexpr double kBin_m = 0.25;
constexpr Reflectivity kGroundReflectivity = 0.3F;

/// Walks along a ray from line to line of one direction.
struct Walk {
  int cell = 0;
  int step = 1;
  double inverse = 0.0;
  double next = kNever;  // range at which the cell is left
};

double range_of(double line, double origin, double inverse) { return (line - origin) * inverse; }

}  // namespace

HeightField::Lines::Lines(double extent_m, double spacing_m, const std::vector<double>& breaks) : extent(extent_m) {
  const int even = std::max(1, static_cast<int>(std::ceil(extent_m / spacing_m)));
  for (int i = 0; i <= even; ++i) {
    at.push_back(extent_m * i / even);
  }
  for (const double line : breaks) {
    for (const double side : {line - kHalfStep_m, line + kHalfStep_m}) {
      if (side > 0.0 && side < extent_m) {
        at.push_back(side);
      }
    }
  }
  std::sort(at.begin(), at.end());
  // Lines that all but coincide would make patches without a width.
  at.erase(std::unique(at.begin(), at.end(), [](double a, double b) { return b - a < 1e-6; }), at.end());
  int line = 0;
  for (double v = 0.0; v < extent_m + kBin_m; v += kBin_m) {
    while (line + 2 < static_cast<int>(at.size()) && at[static_cast<std::size_t>(line) + 1] <= v) {
      ++line;
    }
    first.push_back(line);
  }
}

int HeightField::Lines::patch(double v) const {
  const auto bin = static_cast<std::size_t>(std::clamp(v, 0.0, extent) / kBin_m);
  int line = first[std::min(bin, first.size() - 1)];
  while (line + 2 < static_cast<int>(at.size()) && at[static_cast<std::size_t>(line) + 1] <= v) {
    ++line;
  }
  return line;
}

HeightField::HeightField(const std::function<double(double, double)>& height, const Eigen::Vector2d& extent_m,
                         double spacing_m, const Breaks& breaks)
    : columns_(extent_m.x(), spacing_m, breaks.x), rows_(extent_m.y(), spacing_m, breaks.y), highest_(-kNever) {
  for (const double y : rows_.at) {
    for (const double x : columns_.at) {
      heights_.push_back(static_cast<float>(height(x, y)));
      highest_ = std::max(highest_, static_cast<double>(heights_.back()));
    }
  }
  blocks_across_ = (columns_.patches() + kBlock - 1) / kBlock;
  const int blocks_up = (rows_.patches() + kBlock - 1) / kBlock;
  block_top_.assign(static_cast<std::size_t>(blocks_across_ * blocks_up), -std::numeric_limits<float>::infinity());
  for (int row = 0; row <= rows_.patches(); ++row) {
    for (int column = 0; column <= columns_.patches(); ++column) {
      // A node on a border counts for both sides.
      for (int y = std::max(0, row - 1) / kBlock; y <= std::min(row, rows_.patches() - 1) / kBlock; ++y) {
        for (int x = std::max(0, column - 1) / kBlock; x <= std::min(column, columns_.patches() - 1) / kBlock; ++x) {
          float& top = block_top_[static_cast<std::size_t>(y * blocks_across_ + x)];
          top = std::max(top, node(column, row));
        }
      }
    }
  }
}

double HeightField::height(double x, double y) const {
  const int column = columns_.patch(x);
  const int row = rows_.patch(y);
  const auto share = [](const Lines& lines, int i, double v) {
    const double low = lines.at[static_cast<std::size_t>(i)];
    const double high = lines.at[static_cast<std::size_t>(i) + 1];
    return std::clamp((v - low) / (high - low), 0.0, 1.0);
  };
  const double u = share(columns_, column, x);
  const double v = share(rows_, row, y);
  return (1.0 - v) * ((1.0 - u) * node(column, row) + u * node(column + 1, row)) +
         v * ((1.0 - u) * node(column, row + 1) + u * node(column + 1, row + 1));
}

bool HeightField::cast_patch(int column, int row, const Ray& ray, double from, double to, Hit& best) const {
  const double west = columns_.at[static_cast<std::size_t>(column)];
  const double south = rows_.at[static_cast<std::size_t>(row)];
  const double per_x = 1.0 / (columns_.at[static_cast<std::size_t>(column) + 1] - west);
  const double per_y = 1.0 / (rows_.at[static_cast<std::size_t>(row) + 1] - south);
  const double a = node(column, row);
  const double b = node(column + 1, row) - a;
  const double c = node(column, row + 1) - a;
  const double d = node(column + 1, row + 1) - a - b - c;
  // h = a + b u + c v + d u v; height above it along the ray: C + B s + A s², s from `from` on.
  const double u = (ray.origin.x() + from * ray.direction.x() - west) * per_x;
  const double v = (ray.origin.y() + from * ray.direction.y() - south) * per_y;
  const double du = ray.direction.x() * per_x;
  const double dv = ray.direction.y() * per_y;
  const double C = ray.origin.z() + from * ray.direction.z() - a - b * u - c * v - d * u * v;
  const double B = ray.direction.z() - b * du - c * dv - d * (u * dv + v * du);
  const double A = -d * du * dv;
  const double length = to - from;
  double s = 0.0;
  if (C < 0.0) {
    if (C < -1e-4) {
      return false;  // the ray runs below the ground
    }
  } else {
    if (C + length * (B + A * length) >= 0.0) {
      return false;
    }
    const double root = std::sqrt(std::max(0.0, B * B - 4.0 * A * C));
    s = B < 0.0 ? 2.0 * C / (-B + root) : (std::abs(A) > 0.0 ? (-B - root) / (2.0 * A) : 0.0);
    s = std::clamp(s, 0.0, length);
  }
  if (from + s < best.range_m) {
    const double slope_x = (b + d * (v + s * dv)) * per_x;
    const double slope_y = (c + d * (u + s * du)) * per_y;
    const double across = ray.direction.z() - slope_x * ray.direction.x() - slope_y * ray.direction.y();
    best = {from + s, std::abs(across) / std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y), kGroundReflectivity};
  }
  return true;
}

bool HeightField::cast_patches(const Ray& ray, double from, double to, Hit& best) const {
  const auto begin = [&](const Lines& lines, int axis) {
    Walk walk;
    const double d = ray.direction[axis];
    walk.cell = lines.patch(ray.origin[axis] + (from + 1e-9) * d);
    walk.step = d > 0.0 ? 1 : -1;
    if (std::abs(d) > 1e-12) {
      walk.inverse = 1.0 / d;
      walk.next =
          range_of(lines.at[static_cast<std::size_t>(walk.cell + (d > 0.0 ? 1 : 0))], ray.origin[axis], walk.inverse);
    }
    return walk;
  };
  Walk x = begin(columns_, 0);
  Walk y = begin(rows_, 1);
  while (from < to) {
    const double leave = std::max(from, std::min({x.next, y.next, to}));
    if (cast_patch(x.cell, y.cell, ray, from, leave, best)) {
      return true;
    }
    from = leave;
    const bool across = x.next < y.next;
    Walk& walk = across ? x : y;
    const Lines& lines = across ? columns_ : rows_;
    walk.cell += walk.step;
    if (walk.cell < 0 || walk.cell >= lines.patches()) {
      return false;
    }
    walk.next = range_of(lines.at[static_cast<std::size_t>(walk.cell + (walk.step > 0 ? 1 : 0))],
                         ray.origin[across ? 0 : 1], walk.inverse);
  }
  return false;
}

void HeightField::cast(const Ray& ray, Hit& best) const {
  double from = 0.0;
  double to = best.range_m;
  // Only what lies over the field and below its highest point.
  const auto clip = [&](double origin, double direction, double low, double high) {
    if (std::abs(direction) < 1e-12) {
      if (origin < low || origin > high) {
        to = -1.0;
      }
      return;
    }
    const double a = (low - origin) / direction;
    const double b = (high - origin) / direction;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  };
  clip(ray.origin.x(), ray.direction.x(), 0.0, columns_.extent);
  clip(ray.origin.y(), ray.direction.y(), 0.0, rows_.extent);
  clip(ray.origin.z(), ray.direction.z(), -1e6, highest_ + 1e-3);
  if (from >= to) {
    return;
  }
  // Block by block; a block is looked into where the ray is below its top.
  const auto begin = [&](const Lines& lines, int axis) {
    Walk walk;
    const double d = ray.direction[axis];
    walk.cell = lines.patch(ray.origin[axis] + (from + 1e-9) * d) / kBlock;
    walk.step = d > 0.0 ? 1 : -1;
    walk.inverse = std::abs(d) > 1e-12 ? 1.0 / d : 0.0;
    return walk;
  };
  const auto leave = [&](const Lines& lines, const Walk& walk, int axis) {
    if (walk.inverse == 0.0) {
      return kNever;
    }
    const int line = std::clamp((walk.cell + (walk.step > 0 ? 1 : 0)) * kBlock, 0, lines.patches());
    return range_of(lines.at[static_cast<std::size_t>(line)], ray.origin[axis], walk.inverse);
  };
  Walk x = begin(columns_, 0);
  Walk y = begin(rows_, 1);
  x.next = leave(columns_, x, 0);
  y.next = leave(rows_, y, 1);
  const int blocks_up = static_cast<int>(block_top_.size()) / blocks_across_;
  while (from < to) {
    const double end = std::max(from, std::min({x.next, y.next, to}));
    const double lowest = ray.origin.z() + (ray.direction.z() < 0.0 ? end : from) * ray.direction.z();
    if (lowest <= block_top_[static_cast<std::size_t>(y.cell * blocks_across_ + x.cell)] &&
        cast_patches(ray, from, end, best)) {
      return;
    }
    from = end;
    if (x.next < y.next) {
      x.cell += x.step;
      if (x.cell < 0 || x.cell >= blocks_across_) {
        return;
      }
      x.next = leave(columns_, x, 0);
    } else {
      y.cell += y.step;
      if (y.cell < 0 || y.cell >= blocks_up) {
        return;
      }
      y.next = leave(rows_, y, 1);
    }
  }
}

void HeightField::cast_brute_force(const Ray& ray, Hit& best) const {
  double from = 0.0;
  double to = best.range_m;
  for (int axis = 0; axis < 2; ++axis) {
    const double extent = axis == 0 ? columns_.extent : rows_.extent;
    const double d = ray.direction[axis];
    if (std::abs(d) > 1e-12) {
      const double a = -ray.origin[axis] / d;
      const double b = (extent - ray.origin[axis]) / d;
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    }
  }
  cast_patches(ray, from, to, best);
}

}  // namespace slamd::simulate
