#pragma once

#include <vector>

#include "tools/simulate/surfaces.hpp"

namespace slamd::simulate {

/// Something that moves through the world on a closed path at a steady pace: a car, a person.
/// Frames: its boxes stand in its own axes, x ahead, z from the ground up.  Units: m.
struct Mover {
  std::vector<Eigen::Vector2d> path;  // closed; even steps of kStep_m; see sampled
  std::vector<double> ground_m;       // at each of its points
  std::vector<OrientedBox> boxes;
  double speed_mps = 1.0;
  double start_m = 0.0;  // along the path at time 0

  static constexpr double kStep_m = 0.25;
};

/// Where a mover is at a moment.
struct MoverPlace {
  Eigen::Vector3d position;
  double yaw_rad = 0.0;
};

MoverPlace place_of(const Mover& mover, double t_s);

/// Returns a polyline as the points of a closed path in even steps.
std::vector<Eigen::Vector2d> sampled(const std::vector<Eigen::Vector2d>& corners);

/// Returns the boxes of a car and of a person.
std::vector<OrientedBox> car_boxes();
std::vector<OrientedBox> person_boxes();

}  // namespace slamd::simulate
