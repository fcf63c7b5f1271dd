#include "core/mapping/proximity.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::mapping {

void NearestPasses::offer(const Nearby& nearby, const KeyframeStore& keyframes) {
  const auto is_nearer = [](const Nearby& a, const Nearby& b) { return a.distance_m < b.distance_m; };
  const double path_m = keyframes[nearby.keyframe].path_m;
  for (Nearby& other : nearest_) {
    if (std::abs(keyframes[other.keyframe].path_m - path_m) < config_.apart_m) {
      if (is_nearer(nearby, other)) {
        other = nearby;
        std::sort(nearest_.begin(), nearest_.end(), is_nearer);
      }
      return;
    }
  }
  if (nearest_.full()) {
    if (nearest_.empty() || !is_nearer(nearby, nearest_.back())) {
      return;
    }
    nearest_.back() = nearby;
  } else {
    nearest_.push_back(nearby);
  }
  std::sort(nearest_.begin(), nearest_.end(), is_nearer);
}

}  // namespace slamd::mapping
