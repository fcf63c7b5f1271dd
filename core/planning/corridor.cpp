#include "core/planning/corridor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/assert.hpp"

namespace slamd::planning {

using occupancy::CellIndex;
using occupancy::CellState;
using occupancy::StateMap;

namespace {

/// Rounding may not cost the vehicle its room.
constexpr double kSlack_m = 1e-6;

HalfSpace half_space(const Eigen::Vector3d& normal, double offset_m) { return {{normal.x(), normal.y(), normal.z()}, offset_m}; }

/// Returns how far a cell reaches from its middle against a direction.
double reach_of(const Eigen::Vector3d& normal, double half_m) { return half_m * normal.cwiseAbs().sum(); }

/// The plane through the obstacle's cell, its normal given: the whole cell is outside or on it.
HalfSpace before_cell(const Eigen::Vector3d& normal, const Eigen::Vector3d& middle, double half_m) {
  return half_space(normal, normal.dot(middle) - reach_of(normal, half_m));
}

Eigen::Vector3d nearest_in_cell(const Eigen::Vector3d& p, const Eigen::Vector3d& middle, double half_m) {
  return p.cwiseMax(middle - Eigen::Vector3d::Constant(half_m)).cwiseMin(middle + Eigen::Vector3d::Constant(half_m));
}

/// The plane of the shortest connection of segment and cell, which lies along the cell. The distance is convex along the
/// segment, so that thirds find it.
HalfSpace between(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& middle, double half_m) {
  double low = 0.0;
  double high = 1.0;
  const auto distance = [&](double t) {
    const Eigen::Vector3d p = from + t * (to - from);
    return (nearest_in_cell(p, middle, half_m) - p).norm();
  };
  for (int i = 0; i < 60; ++i) {
    const double third = (high - low) / 3.0;
    if (distance(low + third) <= distance(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  const Eigen::Vector3d p = from + 0.5 * (low + high) * (to - from);
  const Eigen::Vector3d normal = (nearest_in_cell(p, middle, half_m) - p).stableNormalized();
  return before_cell(normal, middle, half_m);
}

double room_of(const HalfSpace& plane, const Eigen::Vector3d& from, const Eigen::Vector3d& to) { return std::min(plane.room(from), plane.room(to)); }

/// Axes whose first is along a direction.
Eigen::Matrix3d axes_along(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d x = direction.norm() > 1e-9 ? direction.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  const Eigen::Vector3d aside = std::abs(x.z()) < 0.9 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  Eigen::Matrix3d axes;
  axes.col(0) = x;
  axes.col(1) = aside.cross(x).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace

double Polyhedron::room(const Eigen::Vector3d& p) const {
  double least = std::numeric_limits<double>::infinity();
  for (const HalfSpace& plane : planes) {
    least = std::min(least, plane.room(p));
  }
  return least;
}

CorridorBuilder::CorridorBuilder(const CorridorConfig& config) : config_(config), middles_(config.obstacles) {}

CorridorResult CorridorBuilder::build(const StateMap& map, std::span<const Eigen::Vector3d> path, BoundedVector<CorridorPiece>& pieces) {
  pieces.clear();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    CorridorPiece piece;
    if (const CorridorFault fault = grow(map, path[i], path[i + 1], piece); fault != CorridorFault::kNone) {
      return {fault, i};
    }
    pieces.push_back(piece);
  }
  return {};
}

bool CorridorBuilder::collect(const StateMap& map, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  middles_.clear();
  const CellIndex first = occupancy::cell_of(low, map.cell_m());
  const CellIndex last = occupancy::cell_of(high, map.cell_m());
  for (std::int32_t z = first.z; z <= last.z; ++z) {
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      for (std::int32_t x = first.x; x <= last.x; ++x) {
        const CellState state = map.at({x, y, z});
        const bool blocks = state == CellState::kOccupied || (config_.unknown_blocks && state == CellState::kUnknown);
        if (blocks && !middles_.try_push_back(occupancy::centre_of({x, y, z}, map.cell_m()))) {
          return false;
        }
      }
    }
  }
  return true;
}

/// Returns the ellipsoid about a segment: first round about it and as wide as no obstacle's middle allows, then as deep.
Ellipsoid CorridorBuilder::shrunk(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
  const double half = std::max(1e-3, 0.5 * (to - from).norm());
  Ellipsoid ellipsoid;
  ellipsoid.d = 0.5 * (from + to);
  Eigen::Matrix3d axes = axes_along(to - from);
  // The radius across at which an obstacle would lie on the surface: the least is the second axis, through that obstacle.
  double second = half;
  Eigen::Vector3d towards = axes.col(1);
  for (const Eigen::Vector3d& middle : middles_) {
    const Eigen::Vector3d local = axes.transpose() * (middle - ellipsoid.d);
    const double along = local.x() / half;
    const double across = std::hypot(local.y(), local.z());
    if (std::abs(along) < 1.0 && across < second * std::sqrt(1.0 - along * along)) {
      second = std::max(1e-3, across / std::sqrt(1.0 - along * along));
      towards = local.y() * axes.col(1) + local.z() * axes.col(2);
    }
  }
  if (towards.norm() > 1e-9) {
    axes.col(1) = towards.normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
  }
  double third = half;
  for (const Eigen::Vector3d& middle : middles_) {
    const Eigen::Vector3d local = axes.transpose() * (middle - ellipsoid.d);
    const double left = 1.0 - std::pow(local.x() / half, 2) - std::pow(local.y() / second, 2);
    if (left > 1e-9) {
      third = std::min(third, std::max(1e-3, std::abs(local.z()) / std::sqrt(left)));
    }
  }
  ellipsoid.C = axes * Eigen::Vector3d(half, second, std::max(third, 1e-3)).asDiagonal();
  return ellipsoid;
}

CorridorFault CorridorBuilder::grow(const StateMap& map, const Eigen::Vector3d& from, const Eigen::Vector3d& to, CorridorPiece& piece) {
  const double half_m = 0.5 * map.cell_m();
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(config_.reach_m);
  Eigen::Vector3d low = from.cwiseMin(to) - reach;
  const Eigen::Vector3d high = from.cwiseMax(to) + reach;
  // The ground, as far as it is a plane to stand on: cells below it are none of the obstacles.
  const double floor_m = std::min(from.z(), to.z()) - config_.floor_m;
  low.z() = std::max(low.z(), floor_m);
  if (!collect(map, low + Eigen::Vector3d::Constant(1e-9), high)) {
    return CorridorFault::kTooManyObstacles;
  }
  piece.ellipsoid = shrunk(from, to);
  Polyhedron& polyhedron = piece.polyhedron;
  polyhedron.planes.clear();
  for (int axis = 0; axis < 3; ++axis) {
    polyhedron.planes.push_back(half_space(Eigen::Vector3d::Unit(axis), high[axis]));
    polyhedron.planes.push_back(half_space(-Eigen::Vector3d::Unit(axis), -low[axis]));
  }
  const Eigen::Matrix3d inverse = piece.ellipsoid.C.inverse();
  while (!middles_.empty()) {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < middles_.size(); ++i) {
      const double level = (inverse * (middles_[i] - piece.ellipsoid.d)).squaredNorm();
      if (level < least) {
        least = level;
        nearest = i;
      }
    }
    const Eigen::Vector3d middle = middles_[nearest];
    const Eigen::Vector3d normal = (inverse.transpose() * (inverse * (middle - piece.ellipsoid.d))).stableNormalized();
    HalfSpace plane = before_cell(normal, middle, half_m);
    if (room_of(plane, from, to) < config_.radius_m + kSlack_m) {
      plane = between(from, to, middle, half_m);
      if (!(room_of(plane, from, to) >= config_.radius_m)) {
        return CorridorFault::kTooClose;
      }
    }
    if (!polyhedron.planes.try_push_back(plane)) {
      return CorridorFault::kTooManyPlanes;
    }
    const Eigen::Vector3d n = Eigen::Vector3d::Map(plane.normal);
    const double reach_m = reach_of(n, half_m);
    const auto outside = [&](const Eigen::Vector3d& m) { return n.dot(m) - reach_m >= plane.offset_m - 1e-9; };
    middles_.resize(static_cast<std::size_t>(std::remove_if(middles_.begin(), middles_.end(), outside) - middles_.begin()));
  }
  for (const HalfSpace& plane : polyhedron.planes) {
    if (room_of(plane, from, to) < config_.radius_m) {
      return CorridorFault::kTooClose;  // the floor, or a reach shorter than the vehicle
    }
  }
  return CorridorFault::kNone;
}

}  // namespace slamd::planning
