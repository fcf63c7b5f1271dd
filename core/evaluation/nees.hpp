#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/evaluation/errors.hpp"

namespace slamd::evaluation {

/// A motion between two estimated poses, and how well the estimator says it knows it.
struct MotionClaim {
  Stamp first{};
  Stamp last{};
  geometry::Matrix6d covariance = geometry::Matrix6d::Identity();  // of (δp, δθ) of T_first_last, δp in the first's axes
};

/// By how much a motion is wrong, and its covariance.
struct MotionError {
  geometry::Vector6d error;
  geometry::Matrix6d covariance;
};

/// Holds claims against the reference: e = boxminus(Q_i⁻¹Q_j, P_i⁻¹P_j), position in body i's axes, then rotation (Q
/// reference, P estimate).  Units: m, rad. Motions, because the covariance of an odometry's pose in odom hides that its
/// first pose is exact. Claims without a pose of the pairs at both stamps are left out.
/// `pairs` in the order of their stamps.
std::vector<MotionError> motion_errors(std::span<const PosePair> pairs, std::span<const MotionClaim> claims);

/// Whether covariances can be believed: with honest ones the mean is the degrees of freedom, and 0.95 of the values lie
/// within the region of 95 %.
struct Consistency {
  std::size_t count = 0;
  double mean = 0.0;       // of the normalised estimation error squared, eᵀP⁻¹e
  double inside_95 = 0.0;  // share with no more than χ²'s 0.95 quantile
};

/// The consistency of motions as a whole, of its parts, and of each axis by itself.
struct MotionConsistency {
  Consistency pose;      // six degrees of freedom
  Consistency position;  // three
  Consistency rotation;
  std::array<Consistency, 6> axes;  // one each: x, y, z, and turns about them
  geometry::Vector6d error_rms = geometry::Vector6d::Zero();  // m, rad
  geometry::Vector6d claimed_rms = geometry::Vector6d::Zero();
};

/// Errors: throws std::invalid_argument when a covariance is not positive definite.
MotionConsistency consistency_of(std::span<const MotionError> errors);

}  // namespace slamd::evaluation
