#pragma once

#include "core/geometry/se3.hpp"

namespace slamd::graph {

/// A pose known from elsewhere: the anchor that holds the map's origin and yaw, or a pose in an older map. Its information
/// may be zero along what it does not know (an anchor leaves roll and pitch to gravity).
struct PriorFactor {
  geometry::Se3 T_map_base;
  geometry::Matrix6d information = geometry::Matrix6d::Identity();  // of (δp in map, δθ in base)
};

/// A residual with its derivative by (δp, δθ).
struct PriorLinearised {
  geometry::Vector6d residual;
  geometry::Matrix6d J_pose;
};

/// Returns T_map_base ⊟ the prior's.  Units: m, rad.
geometry::Vector6d residual_of(const PriorFactor& factor, const geometry::Se3& T_map_base);

/// Returns the residual with its derivative: identity and Jr⁻¹.
PriorLinearised linearise(const PriorFactor& factor, const geometry::Se3& T_map_base);

/// Returns the information of an anchor: position and yaw held to 1 mm and 0.05 mrad, roll and pitch free. For a pose that is
/// level to a few degrees, whose own z axis is the map's.
geometry::Matrix6d anchor_information();

}  // namespace slamd::graph
