#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"
#include "core/mapping/graph_uncertainty.hpp"
#include "core/mapping/keyframe_store.hpp"

namespace slamd::mapping {

/// Where the map takes a keyframe.
struct NoveltyConfig {
  double spacing_indoor_m = 1.0;    // of keyframes where the map has none like it
  double spacing_outdoor_m = 2.0;
  double turn_rad = 0.6;            // 35°: another view
  double known_spacing = 4.0;       // times the spacing, where the map has one like it: what ties the way to it
  double known_std_m = 0.3;         // only where it is known so well where that one lies
  double recent_m = 20.0;           // of the way: what lies there was just seen
  Duration renew_after = std::chrono::hours(24);  // older ones are not like what is there now
};

/// Why a scan becomes a keyframe.
enum class Novelty : std::uint8_t { kNone, kNew, kTie };

/// A scan as the choice sees it.
/// Frames: T_map_base by the newest correction; T_last_base from the last keyframe, if there was one.
struct Place {
  Stamp stamp{};
  geometry::Se3 T_map_base;
  std::optional<geometry::Se3> T_last_base;
  double path_m = 0.0;
  bool indoor = false;
};

/// Tells whether a scan becomes a keyframe: where it is a spacing away from the last one, or turned away from it, and the
/// map has none like it: none as near that looks the same way, is not older than renew_after and is known to lie there. On
/// known ground, one in known_spacing spacings ties the way to it. T_map_base is asked for by index.
template <typename PoseOf>
Novelty novelty_of(const Place& place, const NoveltyConfig& config, const KeyframeStore& keyframes,
                   const GraphUncertainty& uncertainty, PoseOf&& T_map_base) {
  const double spacing_m = place.indoor ? config.spacing_indoor_m : config.spacing_outdoor_m;
  if (!place.T_last_base) {
    return Novelty::kNew;
  }
  const double way_m = place.T_last_base->translation().norm();
  const double turn_rad = geometry::angle_between(Eigen::Matrix3d::Identity(), place.T_last_base->rotation());
  if (way_m < spacing_m && turn_rad < config.turn_rad) {
    return Novelty::kNone;
  }
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const Keyframe& keyframe = keyframes[i];
    const bool is_recent = place.path_m - keyframe.path_m < config.recent_m;
    if (is_recent || place.stamp - keyframe.stamp > config.renew_after) {
      continue;
    }
    const geometry::Se3 T = T_map_base(i);
    const bool is_near = (T.translation() - place.T_map_base.translation()).norm() < spacing_m &&
                         geometry::angle_between(T.rotation(), place.T_map_base.rotation()) < config.turn_rad;
    if (is_near && i < uncertainty.size() && uncertainty.position_std_m(i) < config.known_std_m) {
      return way_m < config.known_spacing * spacing_m ? Novelty::kNone : Novelty::kTie;
    }
  }
  return Novelty::kNew;
}

}  // namespace slamd::mapping
