#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace slamd::graph {

/// How the axes east, north, up lie in the map: a yaw and a translation, for both are levelled. One variable of the graph.
struct GnssAlignment {
  double yaw_rad = 0.0;
  Eigen::Vector3d p_map_enu = Eigen::Vector3d::Zero();  // the origin of east, north, up in map

  Eigen::Matrix3d R_map_enu() const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& p_enu) const { return R_map_enu() * p_enu + p_map_enu; }
  Eigen::Vector3d inverse_times(const Eigen::Vector3d& p_map) const {
    return R_map_enu().transpose() * (p_map - p_map_enu);
  }
};

/// The alignment's error (δp, δyaw), added to its parts. Units: m, rad.
using Vector4d = Eigen::Vector4d;
GnssAlignment boxplus(const GnssAlignment& alignment, const Vector4d& delta);

/// An antenna's place as the map has it and as the receiver has it. Units: m; horizontal_std_m is 1σ an axis.
struct AlignedPair {
  Eigen::Vector3d p_map;
  Eigen::Vector3d p_enu;
  double horizontal_std_m = 1.0;
  double vertical_std_m = 1.0;
};

/// The first alignment, before the graph has one, with what the motion tells of it.
struct AlignmentEstimate {
  GnssAlignment alignment;
  double yaw_std_rad = 0.0;
  double extent_m = 0.0;  // the greatest horizontal distance of a trusted fix from the first trusted one
};

/// Fits yaw and translation to pairs, from which outliers are taken by graduated non-convexity.
/// Source: the horizontal part of Horn's closed form; weights after [Yang20], Eq. (14).
/// Real-time: no allocation; weights.size() must be pairs.size() and is scratch.
AlignmentEstimate fit_alignment(std::span<const AlignedPair> pairs, std::span<double> weights);

}  // namespace slamd::graph
