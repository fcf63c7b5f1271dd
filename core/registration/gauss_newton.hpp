#pragma once

#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/map/voxel_map.hpp"
#include "core/registration/constraint.hpp"

namespace slamd::registration {

/// How points are aligned to the map's surfaces.
struct GaussNewtonConfig {
  int iterations = 6;
  double kernel_m = 0.2;       // Cauchy
  float gate_first_m = 1.0F;   // association gate, shrinking geometrically to gate_last_m
  float gate_last_m = 1.0F;
  int coarse_iterations = 0;   // of `iterations`, on the level of the larger cells
  double damping = 1e-3;       // relative to the largest diagonal element: weak directions stay where they are
};

/// The widest basin: half of the iterations on the larger cells, with a gate that shrinks from 2 m to 0.3 m.
inline constexpr GaussNewtonConfig kCoarseToFine{
    .iterations = 30, .gate_first_m = 2.0F, .gate_last_m = 0.3F, .coarse_iterations = 15};

/// Moves a pose to where the points lie on the map's planes and lines; the wide-basin alignment that serves the
/// swarm's modes, the coarse-to-fine candidate, and later loop verification.
/// Real-time: no allocation; `scratch` holds two constraints a point.
geometry::Se3 align_to_surfaces(std::span<const Eigen::Vector3f> points_imu,
                                const map::VoxelMap& map,
                                const geometry::Se3& T_odom_imu_start,
                                const GaussNewtonConfig& config,
                                BoundedVector<Constraint>& scratch);

}  // namespace slamd::registration
