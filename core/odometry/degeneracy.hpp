#pragma once

#include <cstdint>

#include "core/geometry/se3.hpp"

namespace slamd::odometry {

/// Names the axes along or about which a scan says next to nothing.
///
/// The information of the positions, given that the turns are found too (Schur complement), is compared with the
/// sum over all axes; an axis is weak where it mainly lies in an eigenvector with less than `share` of the sum.
/// The same for the turns. Bits 0..2: x, y, z; 3..5: turns about them.
/// Source: eigenvalue test after Zhang, Kaess and Singh (2016), made free of units by the ratio.
/// Real-time: no allocation.
std::uint8_t weak_axes(const geometry::Matrix6d& information, double share);

}  // namespace slamd::odometry
