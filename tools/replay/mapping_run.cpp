#include "tools/replay/mapping_run.hpp"

#include <cerrno>
#include <cstring>

#include "daemon/stages/preprocess_stage.hpp"
#include "drivers/recording/packet.hpp"

namespace slamd::replay {

using stages::thread_cpu_ms;

namespace {

/// Words for loop_trials.csv.
const char* word_of(const mapping::LoopTrial& trial, const std::optional<graph::LoopVerdict>& end) {
  using graph::LoopVerdict;
  using graph::Proposal;
  if (trial.verification.verdict != loop::Verdict::kVerified) {
    return loop::name_of(trial.verification.verdict);
  }
  if (end) {
    switch (*end) {
      case LoopVerdict::kAccepted:
      case LoopVerdict::kTakenBack: return "accepted";
      case LoopVerdict::kTakenOut: return "taken_out";
      case LoopVerdict::kGivenUp: return "given_up";
      case LoopVerdict::kNoRoom: return "no_room";
    }
  }
  switch (trial.graph_says) {
    case Proposal::kPending: return "pending";
    case Proposal::kContradictsOdometry: return "contradicts_odometry";
    case Proposal::kPendingFull: return "pending_full";
    case Proposal::kKnownPair: return "known_pair";
    case Proposal::kNoKeyframe: return "no_keyframe";
  }
  return "";
}

}  // namespace

MappingRun::MappingRun(const mapping::MapperConfig& config, const std::filesystem::path& directory, const storage::SessionBegin& begin)
    : stage_(config), session_(directory / "session", begin, {}), loops_file_(directory / "loop_trials.csv") {}

void MappingRun::note(const mapping::MapperUpdate& update) {
  session_.note(stage_.mapper(), update);
  for (const mapping::LoopTrial& trial : update.trials) {
    trials_.push_back({trial, std::nullopt});
  }
  for (const graph::LoopEvent& event : update.loops) {
    for (Trial& trial : trials_) {
      const bool is_meant = trial.trial.verification.verdict == loop::Verdict::kVerified && trial.trial.loop == event.id;
      trial.end = is_meant ? std::optional(event.verdict) : trial.end;
    }
  }
}

void MappingRun::add(const ScanRecord& record, const scan::DeskewedScan& scan, const odometry::MotionStep& motion) {
  const double begin_ms = thread_cpu_ms();
  const mapping::MapperUpdate update = stage_.process(stages::scan_for_map(record.odometry, motion, 1), scan.map_points_imu.view());
  ms_.push_back(thread_cpu_ms() - begin_ms);
  note(update);
}

void MappingRun::write_loops() {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(loops_file_.c_str(), "wb"), std::fclose);
  if (!file) {
    throw recording::RecordingError(loops_file_, std::strerror(errno));
  }
  std::fputs("candidate_ns,query_ns,verdict,overlap,inliers,residual_m,seen_through,runner_up,guess_x_m,guess_y_m,guess_z_m,guess_std_m,"
             "x_m,y_m,z_m,qx,qy,qz,qw,std_x_m,std_y_m,std_z_m,std_roll_rad,std_pitch_rad,std_yaw_rad\n",
             file.get());
  for (const Trial& trial : trials_) {
    const loop::Verification& found = trial.trial.verification;
    const Eigen::Vector3d guess = trial.trial.proposal.T_candidate_query.translation();
    const Eigen::Vector3d p = found.T_candidate_query.translation();
    const Eigen::Quaterniond q = found.T_candidate_query.quaternion();
    const geometry::Vector6d deviation = found.covariance.diagonal().cwiseSqrt();
    std::fprintf(file.get(), "%lld,%lld,%s,%.3f,%.3f,%.4f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.4f,%.4f,%.4f,%.6f,%.6f,%.6f,%.6f,%.4f,%.4f,%.4f,%.5f,%.5f,%.5f\n",
                 static_cast<long long>(trial.trial.candidate_stamp.time_since_epoch().count()),
                 static_cast<long long>(trial.trial.query_stamp.time_since_epoch().count()), word_of(trial.trial, trial.end),
                 found.overlap, found.inlier_ratio, found.mean_residual_m, found.seen_through, found.runner_up, guess.x(), guess.y(), guess.z(),
                 trial.trial.proposal.position_std_m, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), deviation[0], deviation[1], deviation[2],
                 deviation[3], deviation[4], deviation[5]);
  }
  if (std::fclose(file.release()) != 0) {
    throw recording::RecordingError(loops_file_, std::strerror(errno));
  }
}

MappingSummary MappingRun::finish() {
  note(stage_.finish());
  session_.close();
  if (const std::string& fault = session_.writer().fault(); !fault.empty()) {
    throw std::runtime_error(fault);
  }
  write_loops();
  const mapping::Mapper& mapper = stage_.mapper();
  MappingSummary summary;
  summary.loops = mapper.counts();
  summary.keyframes = mapper.keyframes().size();
  summary.retired = mapper.retired();
  summary.corrections = mapper.correction_id();
  summary.path = mapper.path();
  summary.ms = std::move(ms_);
  for (const Trial& trial : trials_) {
    if (trial.end == graph::LoopVerdict::kAccepted || trial.end == graph::LoopVerdict::kTakenBack) {
      summary.claimed.push_back({trial.trial.candidate_stamp, trial.trial.query_stamp, trial.trial.verification.T_candidate_query});
    }
  }
  const graph::PoseGraph& graph = mapper.graph();
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    const graph::Loop& loop = graph.loop(k);
    if (loop.enabled && loop.weight > 0.5) {
      summary.edges.emplace_back(graph.node(graph.index_of(loop.a)).T_map_base.translation().cast<float>(),
                                 graph.node(graph.index_of(loop.b)).T_map_base.translation().cast<float>());
    }
  }
  return summary;
}

}  // namespace slamd::replay
