#pragma once

#include "core/geometry/se3.hpp"
#include "core/inertial/nav_state.hpp"

namespace slamd::odometry {

/// What one scan adds to the covariance of motions.
/// Frames: errors (δp, δθ) of T_odom_base, but for drift_base.  Units: m, rad.
struct MotionStep {
  geometry::Se3 T_odom_base;
  inertial::Transition transition = inertial::Transition::Identity();  // of the filter's errors, since the scan before
  /// Covariance of the filter's states with the errors of the pose, in the map as it is.
  Eigen::Matrix<double, inertial::kFilterStates, 6> P_filter_base =
      Eigen::Matrix<double, inertial::kFilterStates, 6>::Zero();
  geometry::Matrix6d J_base_imu = geometry::Matrix6d::Identity();  // errors of T_odom_base by those of T_odom_imu
  geometry::Matrix6d drift_base = geometry::Matrix6d::Zero();      // of the map since the scan before, in base's axes
  /// What the way since the scan before may be wrong by where no surface showed it: one standard deviation, in odom's
  /// axes. Unlike the drift it is the same share of every step.
  Eigen::Vector3d blind_odom = Eigen::Vector3d::Zero();
};

/// The covariance of the motion between two scans: of T_first_last, from a step for each scan between.
///
/// Four parts. The filter's own errors at both ends, with what they have in common: Cov(e_last, e_first) = Φ P_first, Φ
/// the product of all propagations and updates between (as a clone of the first pose in the state would have it). Errors
/// that all points of a scan share, at both ends. And the drift of the map that both were found in: new surfaces are laid
/// at poses that are a little wrong, a random walk over the way, composed along it by the adjoint (map_drift.hpp). And along
/// directions that the scans do not see, what the wheels' scale or the inertial sensor makes of the whole way.
/// Source: stochastic cloning (Roumeliotis and Burdick, 2002); composition after Smith, Self and Cheeseman (1990).
/// Real-time: no allocation; O(18² · 6) a step.
class MotionCovariance {
 public:
  explicit MotionCovariance(const MotionStep& first);

  /// Goes on to the next scan.
  void add(const MotionStep& next);

  /// Returns the covariance of (δp, δθ) of T_first_last: position in the axes of base at the first scan.
  geometry::Matrix6d covariance() const;

 private:
  geometry::Se3 T_odom_first_;
  geometry::Matrix6d P_first_;
  geometry::Se3 T_odom_last_;
  geometry::Matrix6d P_last_;
  Eigen::Matrix<double, inertial::kFilterStates, 6> C_last_first_;  // of all states now with the first pose
  geometry::Matrix6d J_base_imu_;
  geometry::Matrix6d drift_ = geometry::Matrix6d::Zero();  // of T_first_last
  Eigen::Vector3d blind_odom_ = Eigen::Vector3d::Zero();
};

/// Carries the covariance of T_a_b on to T_a_c = T_a_b T_b_c, where `drift_c` is added in c's axes. A turn that is wrong
/// at b moves c with the lever between them.
geometry::Matrix6d composed_drift(const geometry::Matrix6d& drift,
                                  const geometry::Se3& T_a_b,
                                  const geometry::Se3& T_b_c,
                                  const geometry::Matrix6d& drift_c);

}  // namespace slamd::odometry
