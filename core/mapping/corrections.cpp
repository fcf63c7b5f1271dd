#include "core/mapping/corrections.hpp"

#include <algorithm>
#include <cstddef>

namespace slamd::mapping {

using geometry::Se3;

Se3 CorrectedPath::T_map_base(Stamp stamp, const Se3& T_odom_base) const {
  if (keyframes_.empty()) {
    return T_odom_base;
  }
  const auto by = [&](const CorrectedKeyframe& keyframe) {
    return keyframe.T_map_base * (keyframe.T_odom_base.inverse() * T_odom_base);
  };
  const auto after = std::upper_bound(keyframes_.begin(), keyframes_.end(), stamp,
                                      [](Stamp s, const CorrectedKeyframe& keyframe) { return s < keyframe.stamp; });
  if (after == keyframes_.begin()) {
    return by(keyframes_.front());
  }
  const CorrectedKeyframe& before = *(after - 1);
  if (after == keyframes_.end()) {
    return by(before);
  }
  const double ratio = to_seconds(stamp - before.stamp) / to_seconds(after->stamp - before.stamp);
  return geometry::interpolate(by(before), by(*after), ratio);
}

}  // namespace slamd::mapping
