#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "tools/simulate/noise.hpp"
#include "tools/simulate/surfaces.hpp"

namespace slamd::simulate {

/// Each of these shortens `best` to where the ray meets the surface from outside, if it does so before best.range_m.

/// `turn` is the cosine and the sine of the box's yaw. Source: slabs, Kay and Kajiya (1986).
inline bool intersect(const OrientedBox& box, const Eigen::Vector2d& turn, const Ray& ray, Hit& best) {
  const double c = turn.x();
  const double s = turn.y();
  const Eigen::Vector3d offset = ray.origin - box.centre;
  const double origin[3] = {c * offset.x() + s * offset.y(), -s * offset.x() + c * offset.y(), offset.z()};
  const double direction[3] = {c * ray.direction.x() + s * ray.direction.y(),
                               -s * ray.direction.x() + c * ray.direction.y(), ray.direction.z()};
  double enter = 0.0;
  double leave = best.range_m;
  int face = -1;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-12) {
      if (std::abs(origin[axis]) > box.half[axis]) {
        return false;
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
      return false;
    }
  }
  if (face < 0 || enter >= best.range_m) {
    return false;
  }
  best = {enter, std::abs(direction[face]), box.reflectivity};
  return true;
}

inline void intersect(const Cylinder& cylinder, const Ray& ray, Hit& best) {
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

inline void intersect(const Crown& crown, std::uint32_t index, const Noise& leaves, const Ray& ray, Hit& best) {
  const Eigen::Vector3d o = ray.origin - crown.centre;
  const double b = o.dot(ray.direction);
  const double discriminant = b * b - o.squaredNorm() + crown.radius * crown.radius;
  if (discriminant < 0.0) {
    return;
  }
  const double root = std::sqrt(discriminant);
  const double enter = std::max(0.0, -b - root);
  const double leave = -b + root;
  if (enter >= leave || enter >= best.range_m) {
    return;
  }
  // How far the ray gets among the leaves: exponential, and its own for each ray and tree.
  const double depth = -crown.free_path_m * std::log(1.0 - leaves.uniform(ray.number * 131 + index));
  const double t = enter + depth;
  if (t < leave && t < best.range_m) {
    best = {t, 0.7, crown.reflectivity};
  }
}

/// Source: Möller and Trumbore (1997).
inline void intersect(const Triangle& triangle, const Ray& ray, Hit& best) {
  const Eigen::Vector3d corner = triangle.corners[0].cast<double>();
  const Eigen::Vector3d e1 = triangle.corners[1].cast<double>() - corner;
  const Eigen::Vector3d e2 = triangle.corners[2].cast<double>() - corner;
  const Eigen::Vector3d p = ray.direction.cross(e2);
  const double determinant = e1.dot(p);
  if (std::abs(determinant) < 1e-14) {
    return;
  }
  const double inverse = 1.0 / determinant;
  const Eigen::Vector3d offset = ray.origin - corner;
  const double u = offset.dot(p) * inverse;
  const Eigen::Vector3d q = offset.cross(e1);
  const double v = ray.direction.dot(q) * inverse;
  // A hair's width over the edge, so that no ray slips between two faces.
  if (u < -1e-9 || v < -1e-9 || u + v > 1.0 + 1e-9) {
    return;
  }
  const double t = e2.dot(q) * inverse;
  if (t > 1e-6 && t < best.range_m) {
    best = {t, std::abs(e1.cross(e2).normalized().dot(ray.direction)), triangle.reflectivity};
  }
}

}  // namespace slamd::simulate
