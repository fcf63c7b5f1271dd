#pragma once

#include <vector>

#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"

namespace slamd::mapping {

/// A keyframe in odom and, corrected, in map.
struct CorrectedKeyframe {
  Stamp stamp{};
  geometry::Se3 T_odom_base;
  geometry::Se3 T_map_base;
};

/// Takes poses in odom to map by the keyframes around them in time: between two keyframes the correction changes
/// evenly. Before the first and after the last it is that of the one keyframe; without keyframes map is odom.
class CorrectedPath {
 public:
  /// Keyframes in the order of their stamps.
  explicit CorrectedPath(std::vector<CorrectedKeyframe> keyframes) : keyframes_(std::move(keyframes)) {}

  /// Returns T_map_base of a scan at `stamp`.
  geometry::Se3 T_map_base(Stamp stamp, const geometry::Se3& T_odom_base) const;

 private:
  std::vector<CorrectedKeyframe> keyframes_;
};

}  // namespace slamd::mapping
