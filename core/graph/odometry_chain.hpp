#pragma once

#include <cstddef>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"

namespace slamd::graph {

/// A motion with the covariance of its error (δp, δθ): position in the axes of its begin, rotation in those of its end.
struct Motion {
  geometry::Se3 T_a_b;
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
};

/// Returns the adjoint of T_a_b in the order (position, rotation): takes twists in b to twists in a.
geometry::Matrix6d adjoint(const geometry::Se3& T_a_b);

/// Returns the covariance of a motion as that of a twist on its right side, T_a_b Exp(ξ), in b's axes.
geometry::Matrix6d right_twist_covariance(const Motion& motion);

/// Returns the motion's covariance from that of a twist on its left side, Exp(ξ) T_a_b, in a's axes.
geometry::Matrix6d covariance_from_left_twist(const geometry::Se3& T_a_b, const geometry::Matrix6d& twist);

/// Composes T_a_b and T_b_c with independent errors.
Motion composed(const Motion& a_b, const Motion& b_c);

/// Returns T_b_a of T_a_b.
Motion inverse(const Motion& a_b);

/// The odometry of all keyframes, from which the motion between any two has its covariance in constant time: as twists
/// in odom the errors of successive motions add up, so a prefix sum holds them all.
/// Errors of successive motions are taken as independent, which the drift of a map is and a bias is not.
class OdometryChain {
 public:
  explicit OdometryChain(std::size_t capacity) : links_(capacity) {}

  std::size_t size() const { return links_.size(); }
  bool full() const { return links_.full(); }
  const geometry::Se3& T_odom_base(std::size_t i) const { return links_[i].T_odom_base; }

  /// Appends a keyframe. covariance: of the motion from the last keyframe (ignored for the first), as
  /// odometry::MotionCovariance has it.
  void push_back(const geometry::Se3& T_odom_base, const geometry::Matrix6d& covariance);

  /// Forgets a keyframe; the motion over it keeps its covariance.
  void erase(std::size_t i);

  /// Returns the covariance of the motion between keyframes i and j as that of a twist in the axes of base at i.
  geometry::Matrix6d spread(std::size_t i, std::size_t j) const;

  /// Returns the motion from keyframe i to j, i < j.
  Motion between(std::size_t i, std::size_t j) const;

 private:
  struct Link {
    geometry::Se3 T_odom_base;
    geometry::Matrix6d sum_odom = geometry::Matrix6d::Zero();  // of all motions up to here, as twists in odom
  };

  BoundedVector<Link> links_;
};

}  // namespace slamd::graph
