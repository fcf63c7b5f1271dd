#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bounded_vector.hpp"
#include "core/loop/loop_net.hpp"

namespace slamd::loop {

/// Names a keyframe; later ones have greater numbers.
using KeyframeNumber = std::uint32_t;

/// A keyframe that may show the same place as the query, by what Loop-Net says. Nothing has been verified.
struct Candidate {
  KeyframeNumber keyframe = 0;
  float overlap_logit = 0.0F;
  float yaw_rad = 0.0F;     // of the query in the keyframe: R_keyframe_query = Rz(yaw_rad), frames level; −π to π
  float yaw_margin = 0.0F;  // see Comparison
};

struct RetrievalConfig {
  std::size_t capacity = 10'000;    // keyframes: 15,876 bytes each
  std::size_t shortlist = 20;       // keyframes nearest by global descriptor that are compared
  std::size_t best = 3;             // candidates at most
  float least_overlap_logit = 0.0F;
};

/// Remembers the descriptors of keyframes and finds those that show the place of another one.
/// Real-time: memory in the constructor only; mapping thread only. search: 128 products a keyframe and a comparison for each of
/// the shortlist, under 2 ms at 10,000.
class Retrieval {
 public:
  explicit Retrieval(const RetrievalConfig& config);

  /// Remembers a keyframe. Returns false where the bank is full; nothing is changed then.
  bool add(KeyframeNumber keyframe, const Descriptor& descriptor);

  /// Forgets a keyframe; one that is not there is no matter.
  void remove(KeyframeNumber keyframe);

  /// Forgets all of them.
  void clear() { keyframes_.clear(); }

  /// Returns the descriptor of a keyframe, or nullptr.
  const Descriptor* find(KeyframeNumber keyframe) const;

  std::size_t size() const { return keyframes_.size(); }

  /// Finds keyframes with numbers below `end` (the recent ones lie beyond it) that show the query's place, those with the
  /// greatest overlap first. Valid until the next call. Where the same place is in the bank many times over, the candidates are
  /// its neighbours: whoever verifies them may stop at the first success.
  std::span<const Candidate> search(LoopNet& net, const Descriptor& query, KeyframeNumber end);

 private:
  struct Near {
    float similarity = 0.0F;
    std::size_t place = 0;
  };

  void shortlist(const Descriptor& query, KeyframeNumber end);

  RetrievalConfig config_;
  BoundedVector<KeyframeNumber> keyframes_;
  std::vector<Descriptor> descriptors_;  // of the keyframes, in the same order

  // scratch, sized once
  BoundedVector<Near> near_;
  BoundedVector<Candidate> candidates_;
};

}  // namespace slamd::loop
