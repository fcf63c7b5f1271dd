#pragma once

#include <span>
#include <vector>

#include "core/evaluation/errors.hpp"

namespace slamd::evaluation {

/// Returns the normalised estimation error squared, eᵀP⁻¹e, of each relative pose.
/// Frames: e = boxminus(Q_i⁻¹Q_j, P_i⁻¹P_j), position in body i's axes, then rotation (Q reference,
/// P estimate); covariances[k] is that of the relative pose of indices[k], in the same order and
/// axes.  Units: m, rad. Relative poses, because the covariance of an odometry's pose in odom hides
/// that its first pose is exact. Errors: throws std::invalid_argument when there are not as many
/// covariances as indices, or one is not positive definite.
std::vector<double> relative_nees(std::span<const PosePair> pairs,
                                  std::span<const IndexPair> indices,
                                  std::span<const geometry::Matrix6d> covariances);

/// Whether covariances can be believed: with honest ones the mean is 6 and 0.95 of the values lie
/// inside.
struct Consistency {
  std::size_t count = 0;
  double mean = 0.0;
  double inside_95 = 0.0;  // share within the two-sided 95 % interval
};

/// Summarises NEES values of six degrees of freedom.
Consistency consistency_of(std::span<const double> nees);

}  // namespace slamd::evaluation
