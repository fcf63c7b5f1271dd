#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace slamd::simulate {

/// Where a tour goes: corners that are visited over and over; a closed tour ends where it began.
struct Route {
  std::vector<Eigen::Vector2d> corners;  // the last is the first again
  double bend_m = 2.8;                   // how far corners are rounded
  std::function<double(double, double)> floor;  // height of what wheels roll on
};

/// A smooth line to follow, with places where a vehicle stops and turns on the spot.
struct CentreLine {
  static constexpr double kStep_m = 0.1;

  std::vector<Eigen::Vector2d> points;  // kStep_m apart or a little less in bends
  std::vector<std::size_t> turns;       // indices of points at which the line has a sharp corner
};

/// Returns at least `length_m` of the route. `sharp` keeps every second corner sharp.
CentreLine centre_line(const Route& route, double length_m, bool sharp);

}  // namespace slamd::simulate
