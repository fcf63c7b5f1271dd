#pragma once

#include <optional>

#include "core/inertial/nav_state.hpp"
#include "core/map/voxel_map.hpp"
#include "core/odometry/localisability.hpp"
#include "core/registration/association.hpp"
#include "core/registration/constraint.hpp"
#include "core/scan/preprocessor.hpp"

namespace slamd::odometry {

/// How the iterated EKF weighs and stops.
struct UpdateConfig {
  registration::AssociationConfig association;
  int max_iterations = 6;
  int associations = 3;           // look-ups of the neighbours; in between the planes stay
  double kernel_m = 0.05;         // Cauchy
  double information_share = 0.6;  // neighbouring points share their errors: this part of them counts
  double converged_m = 0.0005;
  double converged_rad = 0.0001;
  std::size_t min_constraints = 60;
  double degenerate_share = 0.014;  // of the scan's information: a direction with less is weak
};

/// The posterior, and how well it stands.
struct UpdateResult {
  inertial::NavState state;
  inertial::Covariance P = inertial::Covariance::Identity();
  geometry::Matrix6d information = geometry::Matrix6d::Zero();  // of the scan alone, in (δp, δθ)
  Localisability localisability;
  std::size_t constraints = 0;
  double inlier_ratio = 0.0;       // constraints within the kernel
  double matched_ratio = 0.0;      // features that became constraints
  double mean_residual_m = 0.0;
  double innovation = 0.0;         // squared Mahalanobis length of the pose's correction under the prior, 6 DoF
  int iterations = 0;
  bool converged = false;
  bool enough = false;             // constraints for an update; otherwise the prior stands
};

/// Writes what a scan's constraints say of the pose at which they were summed: their number, information and fit.
void note_fit(const registration::NormalEquations& sum,
              const scan::DeskewedScan& scan,
              const UpdateConfig& config,
              UpdateResult& result);

/// Widens the covariance of a prior that excludes (beyond 3σ) a pose which was found to be the right one: in the pose by
/// the error's length in every direction, for what the scan does not see of it is as likely as what it sees; in the
/// velocity by what brought it about within a scan, but no more than a knock does, or what is later found of the error
/// would pass for velocity.
void widen_where_excluded(const inertial::NavState& prior, const geometry::Se3& T_odom_imu, inertial::Covariance& P_prior);

/// Updates the predicted state with a scan: iterated EKF on point-to-plane and point-to-line constraints, in
/// information form. `T_odom_imu_start` is where it is linearised first: the prediction, or the swarm's mode.
/// `remembered_weak_odom` is a direction that counts as weak, whatever the scan shows of it: see WeakMemory.
/// Source: iterated error-state Kalman filter as maximum a posteriori (Bell and Cathey, 1993; Xu et al., 2022).
/// Real-time: no allocation; `association` is scratch.
UpdateResult iterated_update(const inertial::NavState& prior,
                             const inertial::Covariance& P_prior,
                             const scan::DeskewedScan& scan,
                             const map::VoxelMap& map,
                             const geometry::Se3& T_odom_imu_start,
                             const UpdateConfig& config,
                             registration::Association& association,
                             const std::optional<Eigen::Vector3d>& remembered_weak_odom = std::nullopt);

}  // namespace slamd::odometry
