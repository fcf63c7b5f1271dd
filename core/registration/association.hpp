#pragma once

#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/map/voxel_map.hpp"
#include "core/registration/constraint.hpp"
#include "core/registration/neighbour_fit.hpp"
#include "core/scan/preprocessor.hpp"

namespace slamd::registration {

/// What makes a feature a constraint.
struct AssociationConfig {
  float search_radius_m = 1.0F;
  float plane_thickness_m = 0.10F;   // no neighbour further from the fitted plane
  float line_ratio = 3.0F;           // λ₂ > ratio · λ₁ (LOAM)
  float gate_slope = 0.11F;          // |r| < gate_slope · √range (FAST-LIO: 1 − 0.9|r|/√range > 0.9)
  float planar_std_m = 0.05F;        // measurement noise of one point against its plane
  float sparse_std_m = 0.10F;        // the same against a large cell's plane, where neighbours span none
  float sparse_thickness_m = 0.05F;  // a large cell that is thicker is no plane
  float edge_std_m = 0.15F;
  float angular_std_rad = 0.0005F;   // beam direction: grows with range
};

/// What a scan's features are associated to, with what is known of each for the next time.
/// Real-time: allocates in the constructor only.
struct Association {
  explicit Association(const scan::PreprocessConfig& config);

  /// Makes ready for a scan, against a map that stays as it is until the next call.
  void begin(const scan::DeskewedScan& scan);

  BoundedVector<Constraint> constraints;  // room for one a planar feature, two an edge
  BoundedVector<NeighbourFit> planar;     // by feature
  BoundedVector<NeighbourFit> edge;
};

/// Fits planes to the neighbours of the planar features, and lines to those of the edges, at a pose: exact nearest
/// neighbours on the fine grid. Writes one constraint per accepted plane, two per line.
/// Frames: features in imu, map in odom.
/// Source: 5-point planes after FAST-LIO2 (Xu et al., 2022), lines after LOAM; by eigen-decomposition.
/// Real-time: no allocation; O(features). Call association.begin before the first time for a scan; the same scan
/// associated anew nearby costs little.
void associate(const scan::DeskewedScan& scan,
               const map::VoxelMap& map,
               const geometry::Se3& T_odom_imu,
               const AssociationConfig& config,
               Association& association);

/// The same against the planes and lines of the coarse grid: one look-up a point, for wide basins.
void associate_surfaces(std::span<const Eigen::Vector3f> points_imu,
                        const map::VoxelMap& map,
                        std::size_t level,
                        float gate_m,
                        const geometry::Se3& T_odom_imu,
                        BoundedVector<Constraint>& out);

}  // namespace slamd::registration
