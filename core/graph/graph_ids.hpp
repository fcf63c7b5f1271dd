#pragma once

#include <cstdint>

namespace slamd::graph {

/// Names a keyframe for as long as the graph lives; later keyframes have greater ones.
using KeyframeId = std::uint32_t;

/// Names a loop from its proposal on, accepted or not; never given twice.
using LoopId = std::uint32_t;

}  // namespace slamd::graph
