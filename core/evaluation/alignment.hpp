#pragma once

#include <span>

#include "core/evaluation/trajectory.hpp"

namespace slamd::evaluation {

/// How an estimate is laid on its reference before errors are taken.
enum class Alignment {
  kNone,
  kSe3,     // rotation and translation (evo -a)
  kSim3,    // and scale (evo -as)
  kYaw,     // turn about the vertical and translation: what a levelled trajectory may be wrong by (posyaw)
  kOrigin,  // the first pose on the first
};

/// p_reference ≈ scale · R p_estimate + t.
struct Similarity {
  geometry::Se3 T_reference_estimate;
  double scale = 1.0;

  geometry::Se3 apply(const geometry::Se3& T_estimate_body) const {
    const Eigen::Matrix3d& R = T_reference_estimate.rotation();
    return {R * T_estimate_body.rotation(),
            scale * (R * T_estimate_body.translation()) + T_reference_estimate.translation()};
  }
};

/// Finds the alignment of the first `count` pairs (0: all).
/// Source: Umeyama (1991); yaw alone after Zhang and Scaramuzza (2018).
/// Errors: throws std::invalid_argument when there are too few poses, or (kSe3, kSim3) they lie on a line.
Similarity align(std::span<const PosePair> pairs, Alignment alignment, std::size_t count = 0);

}  // namespace slamd::evaluation
