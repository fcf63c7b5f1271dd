#pragma once

#include "core/geometry/se3.hpp"

namespace slamd::graph {

/// A measured motion or loop: T_a_b, with the information (inverse covariance) of its error (δp, δθ), position in a's axes
/// and rotation in b's: the form in which odometry::MotionCovariance gives it.
struct BetweenFactor {
  geometry::Se3 T_a_b;
  geometry::Matrix6d information = geometry::Matrix6d::Identity();
};

/// A residual with its derivatives by the perturbations (δp, δθ) of both poses.
struct BetweenLinearised {
  geometry::Vector6d residual;
  geometry::Matrix6d J_a;
  geometry::Matrix6d J_b;
};

/// Returns T_map_a⁻¹ T_map_b ⊟ T_a_b: (R_aᵀ(p_b − p_a) − p_ab, Log(R_abᵀ R_aᵀ R_b)).  Units: m, rad.
geometry::Vector6d residual_of(const BetweenFactor& factor, const geometry::Se3& T_map_a, const geometry::Se3& T_map_b);

/// Returns the residual with ∂r/∂(δp_a, δθ_a) and ∂r/∂(δp_b, δθ_b).
/// Source: by hand from the perturbation of design.md; Jr⁻¹ after Sola et al., Eq. (144).
BetweenLinearised linearise(const BetweenFactor& factor, const geometry::Se3& T_map_a, const geometry::Se3& T_map_b);

}  // namespace slamd::graph
