#pragma once

#include "core/graph/graph_ids.hpp"
#include "core/graph/odometry_chain.hpp"

namespace slamd::graph {

/// A loop that has passed its own gates: keyframe b registered against keyframe a, a < b.
struct LoopCandidate {
  KeyframeId a = 0;
  KeyframeId b = 0;
  Motion motion;        // T_a_b with the registration's covariance
  bool strong = false;  // so well seen that it needs no second loop to say the same
};

}  // namespace slamd::graph
