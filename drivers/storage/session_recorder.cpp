#include "drivers/storage/session_recorder.hpp"

#include "core/base/bounded_vector.hpp"

namespace slamd::storage {

using graph::LoopVerdict;

namespace {

constexpr double kMoved_m = 1e-3;
constexpr double kTurned_rad = 1e-4;

bool has_moved(const geometry::Se3& now, const geometry::Se3& before) {
  const geometry::Vector6d change = boxminus(now, before);
  return change.head<3>().norm() > kMoved_m || change.tail<3>().norm() > kTurned_rad;
}

bool is_believed(LoopVerdict verdict) { return verdict == LoopVerdict::kAccepted || verdict == LoopVerdict::kTakenBack; }

}  // namespace

void SessionRecorder::note(const mapping::Mapper& mapper, const mapping::MapperUpdate& update) {
  if (update.retired) {
    writer_.retire(*update.retired);
    written_.erase(*update.retired);
    std::erase_if(loops_, [&](const auto& entry) { return entry.second.a == *update.retired || entry.second.b == *update.retired; });
  }
  if (update.keyframe_added) {
    note_newest_keyframe(mapper);
  }
  note_loops(update);
  if (update.corrected) {
    note_poses(mapper, 0);
  } else if (update.keyframe_added) {
    note_poses(mapper, mapper.keyframes().size() - 1);
  }
}

void SessionRecorder::note_newest_keyframe(const mapping::Mapper& mapper) {
  const std::size_t i = mapper.keyframes().size() - 1;
  const mapping::Keyframe& keyframe = mapper.keyframes()[i];
  const graph::Node& node = mapper.graph().node(i);
  SessionKeyframe record;
  record.id = keyframe.id;
  record.submap = keyframe.submap;
  record.stamp = keyframe.stamp;
  record.T_odom_base = keyframe.T_odom_base;
  record.R_base_level = keyframe.R_base_level;
  record.path_m = keyframe.path_m;
  record.median_range_m = keyframe.median_range_m;
  record.odometry = node.odometry;
  record.gravity = node.gravity;
  BoundedVector<Eigen::Vector3f> cloud(mapper.keyframes().cloud_points(i));
  mapper.keyframes().append_cloud(i, geometry::Se3(), cloud);
  record.cloud_level.assign(cloud.begin(), cloud.end());
  writer_.write(record);
  written_[keyframe.id] = keyframe.T_odom_base;  // what a reader takes where no pose came
}

void SessionRecorder::note_loops(const mapping::MapperUpdate& update) {
  for (const mapping::LoopTrial& trial : update.trials) {
    if (trial.verification.verdict == loop::Verdict::kVerified && trial.graph_says == graph::Proposal::kPending) {
      const auto& found = trial.verification;
      const graph::BetweenFactor factor{found.T_candidate_query, found.covariance.inverse()};
      const SessionLoop loop{trial.loop, trial.candidate, trial.query, factor, false};
      loops_[trial.loop] = loop;
      writer_.write(loop);
    }
  }
  for (const graph::LoopEvent& event : update.loops) {
    const auto known = loops_.find(event.id);
    if (known != loops_.end() && known->second.accepted != is_believed(event.verdict)) {
      known->second.accepted = !known->second.accepted;
      writer_.write(known->second);
    }
  }
}

void SessionRecorder::note_poses(const mapping::Mapper& mapper, std::size_t from) {
  moved_.clear();
  for (std::size_t i = from; i < mapper.keyframes().size(); ++i) {
    const graph::KeyframeId id = mapper.keyframes()[i].id;
    const geometry::Se3& T_map_base = mapper.T_map_base(i);
    if (has_moved(T_map_base, written_[id])) {
      written_[id] = T_map_base;
      moved_.push_back({id, T_map_base});
    }
  }
  writer_.write(moved_);
}

}  // namespace slamd::storage
