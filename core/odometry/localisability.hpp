#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/geometry/se3.hpp"
#include "core/registration/constraint.hpp"

namespace slamd::odometry {

/// How well a scan holds the position, and the directions along or about which it says next to nothing.
struct Localisability {
  Eigen::Vector3d weakest_odom = Eigen::Vector3d::UnitX();  // direction that the scan sees least of
  double share = 1.0 / 3.0;      // of the scan's information, along it: from surfaces that clearly face it
  double raw_share = 1.0 / 3.0;  // the same from all surfaces, the tilts of their normals included
  double remembered_share = 1.0 / 3.0;  // share along the remembered direction
  std::size_t own_weak = 0;      // directions that this scan itself does not see: the first of `weak`
  registration::WeakDirections weak;        // of the position: those with less than the limit
  registration::WeakDirections weak_turns;  // axes of the turns that are held as badly

  bool is_weak() const { return weak.count + weak_turns.count != 0; }
};

/// Judges what the constraints hold.
///
/// The information on the position, given that the turns are found too (Schur complement), has a weakest direction.
/// Normals are fitted to few noisy points: walls along a tunnel seem to face its axis by a few degrees, and thousands of
/// them by their sum. What that noise adds to the information is taken off before the directions are looked for, or they
/// are turned aside; and each surface counts along a direction by what its normal's tilt cannot explain. The direction
/// is weak where less than `share` of the information is along it; so is `remembered_odom`, whatever its share (see
/// WeakMemory), unless the scan's own weak directions have most of it. Turns are judged by their eigenvalues.
/// Source: eigenvalues after Zhang, Kaess and Singh (2016), made free of units by the ratio; filtered contributions
/// after X-ICP (Tuna et al., 2023).
/// `information` is H of registration::linearize at the same pose.
/// Frames: poses and normals in odom.  Real-time: no allocation; O(constraints).
Localisability localisability_of(std::span<const registration::Constraint> constraints,
                                 const geometry::Matrix6d& information,
                                 const geometry::Se3& T_odom_imu,
                                 double kernel_m,
                                 double share,
                                 const std::optional<Eigen::Vector3d>& remembered_odom = std::nullopt);

/// Names the axes of a frame that the weak directions mainly move: bits 0..2: x, y, z; 3..5: turns about them. A slanted
/// direction marks each axis of which it has more than a fair share.
std::uint8_t weak_axes(const Localisability& localisability, const Eigen::Matrix3d& R_frame_odom);

/// Says weak axes of base in words, such as "ahead, heading".
std::string in_words(std::uint8_t weak_axes_base);

}  // namespace slamd::odometry
