#include "core/mapping/appearance.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::mapping {

using geometry::Se3;

namespace {

/// The candidate's base to the query's, by yaw alone: both stand at the same place.
Se3 guess_of(const Keyframe& candidate, const Keyframe& query, double yaw_rad) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return {candidate.R_base_level * turn * query.R_base_level.transpose(), Eigen::Vector3d::Zero()};
}

}  // namespace

Appearance::Appearance(std::size_t keyframes)
    : bank_({.capacity = keyframes, .shortlist = 20, .best = 20, .least_overlap_logit = 0.0F}),
      image_(std::make_unique<loop::PolarImage>()),
      newest_(std::make_unique<loop::Descriptor>()) {}

void Appearance::add(graph::KeyframeId id, std::span<const Eigen::Vector3f> points_level) {
  imager_.clear();
  imager_.add(Se3(), points_level);
  imager_.finish(*image_);
  net_.describe(*image_, *newest_);
  bank_.add(id, *newest_);  // there are never more than the store holds
}

void Appearance::propose(const KeyframeStore& keyframes, const GraphUncertainty& uncertainty, bool indoor, const AppearanceConfig& config,
                         BoundedVector<loop::LoopProposal>& out) {
  const Keyframe& query = keyframes.back();
  std::size_t end = 0;  // keyframes before it lie far enough behind
  while (end < keyframes.size() && query.path_m - keyframes[end].path_m >= config.recent_m) {
    ++end;
  }
  const auto is_uncertain = [&](std::size_t i) { return uncertainty.position_std_m(i) > config.least_uncertain_m; };
  std::size_t first_uncertain = 0;
  while (first_uncertain < end && !is_uncertain(first_uncertain)) {
    ++first_uncertain;
  }
  if (first_uncertain == end) {
    return;  // as in ordinary drives: no search
  }
  std::size_t proposed = 0;
  for (const loop::Candidate& candidate : bank_.search(net_, *newest_, keyframes[end - 1].id + 1)) {
    const std::size_t i = keyframes.index_of(candidate.keyframe);
    if (i == keyframes.size()) {
      continue;
    }
    const bool is_of_known_pass = std::any_of(out.begin(), out.end(), [&](const loop::LoopProposal& other) {
      return std::abs(keyframes[other.keyframe].path_m - keyframes[i].path_m) < config.apart_m;
    });
    if (is_of_known_pass || !is_uncertain(i)) {
      continue;
    }
    const Se3 T_candidate_query = guess_of(keyframes[i], query, candidate.yaw_rad);
    if (proposed == config.most ||
        !out.try_push_back({i, T_candidate_query, indoor ? config.std_indoor_m : config.std_outdoor_m, config.yaw_std_rad,
                            candidate.overlap_logit, loop::ProposedBy::kView})) {
      return;
    }
    ++proposed;
  }
}

}  // namespace slamd::mapping
