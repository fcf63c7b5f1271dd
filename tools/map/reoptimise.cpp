#include "tools/map/reoptimise.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "core/graph/back_end.hpp"

namespace slamd::map {

using geometry::Matrix6d;

namespace {

/// The covariance that an information matrix stands for; where it is none, of a motion of which nothing is known.
Matrix6d covariance_of(const Matrix6d& information) {
  const Eigen::LLT<Matrix6d> llt(information);
  if (llt.info() != Eigen::Success) {
    constexpr double kNothingKnown = 1e4;
    return kNothingKnown * Matrix6d::Identity();
  }
  return llt.solve(Matrix6d::Identity());
}

}  // namespace

Reoptimised reoptimise(storage::Session& session, const Share& share) {
  graph::BackEndConfig config;
  config.capacity.keyframes = std::max<std::size_t>(session.keyframes.size(), 2);
  config.capacity.loops = std::max<std::size_t>(session.loops.size(), 1);
  graph::BackEnd back_end(config);
  std::multimap<graph::KeyframeId, std::size_t> loops_at;  // of their later keyframe
  for (std::size_t k = 0; k < session.loops.size(); ++k) {
    loops_at.emplace(session.loops[k].b, k);
  }
  std::map<graph::LoopId, std::size_t> loop_of;
  std::vector<bool> accepted(session.loops.size(), false);
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    const storage::SessionKeyframe& keyframe = session.keyframes[i];
    if (!back_end.add_keyframe(keyframe.id, keyframe.T_odom_base, covariance_of(keyframe.odometry.information), keyframe.gravity)) {
      throw std::runtime_error("keyframe " + std::to_string(keyframe.id) + " does not fit into the graph");
    }
    const auto [begin, end] = loops_at.equal_range(keyframe.id);
    for (auto entry = begin; entry != end; ++entry) {
      const storage::SessionLoop& loop = session.loops[entry->second];
      graph::LoopId id = 0;
      back_end.propose({loop.a, loop.b, {loop.factor.T_a_b, covariance_of(loop.factor.information)}, false}, id);
      loop_of[id] = entry->second;
    }
    for (const graph::LoopEvent& event : back_end.update().loops) {
      const auto loop = loop_of.find(event.id);
      if (loop != loop_of.end()) {
        accepted[loop->second] = event.verdict == graph::LoopVerdict::kAccepted || event.verdict == graph::LoopVerdict::kTakenBack;
      }
    }
    if (share) {
      share(static_cast<double>(i + 1) / static_cast<double>(session.keyframes.size()));
    }
  }
  Reoptimised result;
  for (std::size_t k = 0; k < session.loops.size(); ++k) {
    result.accepted += accepted[k] ? 1 : 0;
    result.taken_in += accepted[k] && !session.loops[k].accepted ? 1 : 0;
    result.taken_out += !accepted[k] && session.loops[k].accepted ? 1 : 0;
    session.loops[k].accepted = accepted[k];
  }
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    const geometry::Se3& T_map_base = back_end.graph().node(i).T_map_base;
    if (!T_map_base.translation().allFinite() || !T_map_base.rotation().allFinite()) {
      throw std::runtime_error("the graph has no solution: its factors contradict each other beyond all bounds");
    }
    result.largest_move_m = std::max(result.largest_move_m, (T_map_base.translation() - session.T_map_base[i].translation()).norm());
    session.T_map_base[i] = T_map_base;
  }
  return result;
}

}  // namespace slamd::map
