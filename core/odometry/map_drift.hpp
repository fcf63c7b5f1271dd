#pragma once

#include "core/geometry/se3.hpp"
#include "core/inertial/nav_state.hpp"
#include "core/odometry/motion_covariance.hpp"
#include "core/registration/constraint.hpp"

// What the filter does not know of its own errors, in a few constants; docs/odometry.md, "Uncertainty", has what they were
// measured on. The filter's weights are left alone: this is said beside it.

namespace slamd::odometry {

/// The variance of a point against its plane by the one that the update takes (5 to 10 cm, so that it stays robust): LiDAR
/// and fit err by 2 to 4 cm.
inline constexpr double kTrueNoiseShare = 0.25;

/// Errors that all points of a scan have in common, and that change with the view: the sensors' mounting, stamps, the
/// beams' angles.  Units: rad, about each axis.
inline constexpr double kSharedTurn_rad = 3e-4;

/// Surfaces are renewed about once in a median range of way. What they are laid with is not the error of thousands of
/// independent points, as Σ JᵀJ/σ² has it, but of few: a beam's range error is that of all its points, and
/// a plane's fit that of all the scans which meet it. So much of the inverse information is laid down in a median range.
inline constexpr double kLaidShare = 1.5;

/// The way over which the drift is told in the pose's own covariance: what lies around was laid down on it.
inline constexpr double kSurroundings_m = 10.0;

/// What the way along a direction that the scan does not see may be wrong by, as a share of it, without wheels: the
/// inertial sensor alone carries the pose there.
inline constexpr double kBlindShare = 0.05;

/// And with wheels at least, whatever their scale is believed to be.
inline constexpr double kLeastScaleStd = 0.003;

/// Returns what of a step lies along weak directions, times `share`. Frames: odom.  Units: m.
Eigen::Vector3d blind_way(const registration::WeakDirections& weak, const Eigen::Vector3d& step_odom, double share);

/// Takes the covariance of an update (all states by the pose: columns 0..5 of P) to that of its gain under the points'
/// true noise: P − (1 − kTrueNoiseShare) P H P. Directions that the scan does not see keep theirs.
/// `H` is the information that the update took from the scan, on the pose.
Eigen::Matrix<double, inertial::kFilterStates, 6> with_true_noise(
    const Eigen::Matrix<double, inertial::kFilterStates, 6>& P_pose, const geometry::Matrix6d& H);

/// Covariance of the errors that all points share: of (δp, δθ).
geometry::Matrix6d errors_of_all_points();

/// By how much the map drifts over one step, in base's axes. `information` is that of the scan on T_odom_imu.
geometry::Matrix6d map_drift(const geometry::Matrix6d& information,
                             const geometry::Se3& T_odom_base,
                             const geometry::Matrix6d& J_base_imu,
                             const geometry::Se3& T_last_base,
                             double median_range_m);

/// Turns a covariance of (δp, δθ) of T_odom_base so that δp is in base's axes too.
geometry::Matrix6d in_base_axes(const geometry::Matrix6d& P_odom_base, const geometry::Se3& T_odom_base);

/// The drift of the pose against what lies around it: the last kSurroundings_m of way count, earlier ones fade.
class SurroundingsDrift {
 public:
  /// Goes on by one scan.
  void add(const geometry::Se3& T_odom_last,
           const geometry::Se3& T_odom_base,
           const geometry::Matrix6d& drift_base,
           const Eigen::Vector3d& blind_odom);

  /// Of (δp, δθ) of T_odom_base.
  geometry::Matrix6d covariance() const;

 private:
  geometry::Matrix6d covariance_ = geometry::Matrix6d::Zero();
  Eigen::Vector3d blind_odom_ = Eigen::Vector3d::Zero();
};

}  // namespace slamd::odometry
