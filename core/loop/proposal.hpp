#pragma once

#include <cstddef>
#include <cstdint>

#include "core/geometry/se3.hpp"

namespace slamd::loop {

/// Who believes that two keyframes show the same place.
enum class ProposedBy : std::uint8_t {
  kPlace,  // the graph: they lie near each other
  kView,   // retrieval: they look alike
};

/// A keyframe that the newest one may have seen before, and how it would then lie there.
/// Frames: candidate and query are base at the two keyframes.
struct LoopProposal {
  std::size_t keyframe = 0;            // place of the candidate among the keyframes
  geometry::Se3 T_candidate_query;     // as guessed
  double position_std_m = 1.0;         // of the guess, horizontally: where registration has to look
  double yaw_std_rad = 0.05;
  float score = 0.0F;                  // greater is better; only those of one origin compare
  ProposedBy origin = ProposedBy::kPlace;
};

}  // namespace slamd::loop
