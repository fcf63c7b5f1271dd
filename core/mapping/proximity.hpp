#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/bounded_vector.hpp"
#include "core/loop/proposal.hpp"
#include "core/mapping/graph_uncertainty.hpp"
#include "core/mapping/keyframe_store.hpp"

namespace slamd::mapping {

/// Which keyframes are looked at again because of where they lie.
struct ProximityConfig {
  double reach_share = 0.4;      // of the median range: so far apart two clouds still have enough in common
  double least_reach_m = 1.5;
  double most_reach_m = 8.0;
  double sigmas = 3.0;           // of the uncertainty between the two, added to the reach
  double most_uncertain_m = 8.0;  // beyond, a place alone says nothing
  double height_m = 2.0;         // above or below by less: another storey otherwise
  double view_rad = 3.2;         // between the headings; less for a sensor that does not look around
  double recent_m = 20.0;        // of the way: not the way right behind
  double apart_m = 20.0;         // of the way between two candidates
  std::size_t most = 2;          // candidates for a keyframe
};

/// Proposes keyframes that lie where the newest one lies, within the reach and what the graph does not know of where they lie:
/// nearest first. Two candidates are of different passes. T_map_base is asked for by index.
/// O(keyframes).
template <typename PoseOf>
void propose_by_place(const KeyframeStore& keyframes, const GraphUncertainty& uncertainty, const ProximityConfig& config,
                      PoseOf&& T_map_base, BoundedVector<loop::LoopProposal>& out);

struct Nearby {
  std::size_t keyframe = 0;
  double distance_m = 0.0;  // beyond what the uncertainty explains
};

/// Keeps the nearest of each pass: of candidates within apart_m of the way only one, at most `most`.
class NearestPasses {
 public:
  explicit NearestPasses(const ProximityConfig& config) : config_(config), nearest_(config.most) {}

  void offer(const Nearby& nearby, const KeyframeStore& keyframes);

  const BoundedVector<Nearby>& nearest() const { return nearest_; }

 private:
  const ProximityConfig& config_;
  BoundedVector<Nearby> nearest_;  // in ascending order
};

template <typename PoseOf>
void propose_by_place(const KeyframeStore& keyframes, const GraphUncertainty& uncertainty, const ProximityConfig& config,
                      PoseOf&& T_map_base, BoundedVector<loop::LoopProposal>& out) {
  const std::size_t query = keyframes.size() - 1;
  const geometry::Se3 T_map_query = T_map_base(query);
  NearestPasses passes(config);
  for (std::size_t i = 0; i < query; ++i) {
    if (keyframes.back().path_m - keyframes[i].path_m < config.recent_m) {
      break;
    }
    const double std_m = uncertainty.position_std_m(i);
    if (!(std_m <= config.most_uncertain_m)) {
      continue;
    }
    const geometry::Se3 T_candidate_query = T_map_base(i).inverse() * T_map_query;
    const Eigen::Vector3d& p = T_candidate_query.translation();
    const double distance_m = p.head<2>().norm();
    const double reach_m = std::clamp(config.reach_share * std::min(keyframes[i].median_range_m, keyframes.back().median_range_m),
                                      config.least_reach_m, config.most_reach_m);
    const Eigen::Vector3d ahead = T_candidate_query.rotation().col(0);
    const bool looks_the_same_way = std::abs(std::atan2(ahead.y(), ahead.x())) <=
                                    config.view_rad + config.sigmas * uncertainty.yaw_std_rad(i);
    if (distance_m <= reach_m + config.sigmas * std_m && looks_the_same_way &&
        std::abs(p.z()) <= config.height_m + config.sigmas * uncertainty.height_std_m(i)) {
      passes.offer({i, distance_m}, keyframes);
    }
  }
  for (const Nearby& nearby : passes.nearest()) {
    const std::size_t i = nearby.keyframe;
    out.try_push_back({i, T_map_base(i).inverse() * T_map_query, uncertainty.position_std_m(i), uncertainty.yaw_std_rad(i),
                       static_cast<float>(-nearby.distance_m), loop::ProposedBy::kPlace});
  }
}

}  // namespace slamd::mapping
