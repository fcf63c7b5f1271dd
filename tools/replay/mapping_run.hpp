#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/evaluation/loops.hpp"
#include "core/mapping/corrections.hpp"
#include "daemon/stages/mapping_stage.hpp"
#include "drivers/storage/session_recorder.hpp"
#include "tools/replay/replay.hpp"

namespace slamd::replay {

/// What mapping made of a run.
struct MappingSummary {
  mapping::LoopCounts loops;
  std::size_t keyframes = 0;
  std::uint64_t retired = 0;
  std::uint32_t corrections = 0;
  std::vector<mapping::CorrectedKeyframe> path;
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> edges;  // loops that the graph believes, in map
  std::vector<evaluation::ClaimedLoop> claimed;                    // those that it has believed to the end, retired keyframes' too
  std::vector<double> ms;  // CPU time of each scan
};

/// The mapping stage of a replay, in the replay's one thread: what the daemon's mapping thread does, at once after each
/// scan. Writes loop_trials.csv: a line for each proposal with what registration and graph said of it; and session/, which slamd-map reads.
class MappingRun {
 public:
  MappingRun(const mapping::MapperConfig& config, const std::filesystem::path& directory, const storage::SessionBegin& begin);

  void add(const ScanRecord& record, const scan::DeskewedScan& scan, const odometry::MotionStep& motion);

  /// Takes the last keyframe in, writes loop_trials.csv, closes the session, and says what has come of it all.
  MappingSummary finish();

 private:
  /// A proposal with what became of its loop.
  struct Trial {
    mapping::LoopTrial trial;
    std::optional<graph::LoopVerdict> end;
  };

  void note(const mapping::MapperUpdate& update);
  void write_loops();

  stages::MappingStage stage_;
  storage::SessionRecorder session_;
  std::filesystem::path loops_file_;
  std::vector<Trial> trials_;
  std::vector<double> ms_;
};

}  // namespace slamd::replay
