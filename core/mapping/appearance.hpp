#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/loop/loop_net.hpp"
#include "core/loop/polar_image.hpp"
#include "core/loop/proposal.hpp"
#include "core/loop/retrieval.hpp"
#include "core/mapping/graph_uncertainty.hpp"
#include "core/mapping/keyframe_store.hpp"

namespace slamd::mapping {

/// Which keyframes are looked at again because of what they look like.
struct AppearanceConfig {
  double least_uncertain_m = 3.0;  // as long as the graph knows better where a keyframe lies, its word counts
  double recent_m = 20.0;          // of the way: not the way right behind
  double apart_m = 20.0;           // of the way between two candidates
  std::size_t most = 2;            // candidates for a keyframe
  // Of the guess: positives of Loop-Net's training lie nearer than 5 m, indoors 2 m; its yaw errs by 2° in one of ten.
  double std_indoor_m = 0.8;
  double std_outdoor_m = 2.0;
  double yaw_std_rad = 0.04;
};

/// What the keyframes look like to Loop-Net, for where the graph no longer knows where they lie.
/// Memory: sized once, 15,876 bytes a keyframe.  Mapping thread only: 2 ms a keyframe, and up to 2 ms a search, where a place is uncertain.
class Appearance {
 public:
  explicit Appearance(std::size_t keyframes);

  /// Remembers the newest keyframe by its cloud.  Frames: level.
  void add(graph::KeyframeId id, std::span<const Eigen::Vector3f> points_level);

  void remove(graph::KeyframeId id) { bank_.remove(id); }
  void clear() { bank_.clear(); }

  /// Proposes keyframes that look like the newest one, which was added last; the likeliest first, and none of a pass that `out` has already.
  void propose(const KeyframeStore& keyframes, const GraphUncertainty& uncertainty, bool indoor, const AppearanceConfig& config,
               BoundedVector<loop::LoopProposal>& out);

 private:
  loop::PolarImager imager_;
  loop::LoopNet net_;
  loop::Retrieval bank_;
  std::unique_ptr<loop::PolarImage> image_;     // scratch
  std::unique_ptr<loop::Descriptor> newest_;
};

}  // namespace slamd::mapping
