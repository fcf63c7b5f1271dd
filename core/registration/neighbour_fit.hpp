#pragma once

#include <array>

#include <Eigen/Core>

#include "core/map/voxel_map.hpp"

namespace slamd::registration {

/// Centre and principal axes of a few neighbours.
struct PrincipalAxes {
  Eigen::Vector3f mean;
  Eigen::Vector3f lambda;   // ascending
  Eigen::Matrix3f vectors;  // columns, in the order of lambda
};

/// The neighbours of one point of the scan in the map, and their axes where there are kMax of them. It remembers where the
/// point was when they were looked up: while it moves by less than what the others are farther off, they are still the
/// nearest, and what was fitted to them stays, bit for bit.
/// Frames: odom.
class NeighbourFit {
 public:
  /// Finds the neighbours at p_odom. Between calls without `forget` the map and the radius must not change.
  void look_up(const map::VoxelMap& map, const Eigen::Vector3f& p_odom, float radius_m);

  /// The next call looks into the map.
  void forget() { others_beyond_m_ = 0.0F; }
  bool is_known() const { return others_beyond_m_ > 0.0F; }

  const map::Neighbours& neighbours() const { return neighbours_; }
  bool is_full() const { return neighbours_.count == map::Neighbours::kMax; }
  const PrincipalAxes& axes() const { return axes_; }

 private:
  bool are_still_nearest(const Eigen::Vector3f& p_odom);

  Eigen::Vector3f looked_up_at_odom_ = Eigen::Vector3f::Zero();
  float others_beyond_m_ = 0.0F;  // of the place where they were looked up; 0: nothing is known
  map::Neighbours neighbours_;
  PrincipalAxes axes_;
};

}  // namespace slamd::registration
