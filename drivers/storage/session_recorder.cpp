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
    note_retired(*update.retired);
  }
  if (update.keyframe_added) {
    note_keyframe(mapper, mapper.keyframes().size() - 1);
  }
  note_loops(update);
  if (update.corrected) {
    note_poses(mapper, 0);
  } else if (update.keyframe_added) {
    note_poses(mapper, mapper.keyframes().size() - 1);
  }
}

void SessionRecorder::catch_up(const mapping::Mapper& mapper) {
  std::erase_if(retired_, [&](graph::KeyframeId id) { return writer_.retire(id); });
  for (std::size_t i = 0; i < mapper.keyframes().size(); ++i) {
    if (!written_.contains(mapper.keyframes()[i].id)) {
      note_keyframe(mapper, i);
    }
  }
  const graph::PoseGraph& graph = mapper.graph();
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    const graph::Loop& loop = graph.loop(k);
    loops_.try_emplace(loop.id, KnownLoop{{loop.id, loop.a, loop.b, loop.factor, loop.enabled}, false});
  }
  for (auto& [id, known] : loops_) {
    known.is_written = known.is_written || writer_.write(known.loop);
  }
  note_poses(mapper, 0);
}

void SessionRecorder::note_retired(graph::KeyframeId id) {
  if (written_.erase(id) != 0 && !writer_.retire(id)) {
    retired_.push_back(id);
  }
  std::erase_if(loops_, [&](const auto& entry) { return entry.second.loop.a == id || entry.second.loop.b == id; });
}

void SessionRecorder::note_keyframe(const mapping::Mapper& mapper, std::size_t i) {
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
  if (writer_.write(record)) {
    written_[keyframe.id] = keyframe.T_odom_base;  // what a reader takes where no pose came
  }
}

void SessionRecorder::note_loops(const mapping::MapperUpdate& update) {
  for (const mapping::LoopTrial& trial : update.trials) {
    if (trial.verification.verdict == loop::Verdict::kVerified && trial.graph_says == graph::Proposal::kPending) {
      const auto& found = trial.verification;
      const graph::BetweenFactor factor{found.T_candidate_query, found.covariance.inverse()};
      const SessionLoop loop{trial.loop, trial.candidate, trial.query, factor, false};
      loops_[trial.loop] = {loop, writer_.write(loop)};
    }
  }
  for (const graph::LoopEvent& event : update.loops) {
    const auto known = loops_.find(event.id);
    if (known != loops_.end() && known->second.loop.accepted != is_believed(event.verdict)) {
      known->second.loop.accepted = !known->second.loop.accepted;
      known->second.is_written = writer_.write(known->second.loop);
    }
  }
}

void SessionRecorder::note_poses(const mapping::Mapper& mapper, std::size_t from) {
  moved_.clear();
  for (std::size_t i = from; i < mapper.keyframes().size(); ++i) {
    const auto known = written_.find(mapper.keyframes()[i].id);
    if (known != written_.end() && has_moved(mapper.T_map_base(i), known->second)) {
      moved_.push_back({known->first, mapper.T_map_base(i)});
    }
  }
  if (writer_.write(moved_)) {
    for (const SessionPose& pose : moved_) {
      written_[pose.id] = pose.T_map_base;
    }
  }
}

}  // namespace slamd::storage
