#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "tools/replay/mapping_run.hpp"
#include "tools/replay/output.hpp"
#include "tools/replay/recording.hpp"
#include "tools/replay/replay.hpp"
#include "tools/report/content.hpp"

namespace slamd::replay {

/// One call of slamd-replay: a run with its products, perhaps a second one beside it, and the reports on both.
class Session {
 public:
  Session(Recording recording, std::filesystem::path directory);

  /// Maps the recording; writes odometry.tum, trajectory.tum, scans.csv, motions.csv, map.ply, and with mapping loop_trials.csv. Errors: RecordingError.
  void run(const std::function<void(double)>& progress);

  /// Maps what a source gives in place of a recording's packets, against its truth; writes the same.
  void run(PacketSource& source, const evaluation::Trajectory& truth, const std::function<void(double)>& progress);

  /// Runs another filter on the same recording; writes odometry-<filter>.tum.
  void compare(const std::string& filter, const std::function<void(double)>& progress);

  /// Writes report.json and report.html.
  void write_reports() const;

  /// Returns report.json.
  std::string json() const;

  /// Returns a few lines for a terminal.
  std::string summary() const;

 private:
  std::string filter_name() const;
  bool is_corrected() const { return mapping_ && mapping_->corrections > 0; }
  std::optional<report::FilterRun> map_run() const;
  std::optional<evaluation::LoopQuality> loop_quality() const;
  void run_with(const std::function<Run(const Sinks&)>& replay, const std::function<void(double)>& progress);

  Recording recording_;
  std::filesystem::path directory_;
  evaluation::Trajectory truth_;
  Run run_;
  std::vector<evaluation::MotionClaim> motions_;
  std::vector<Eigen::Vector3f> map_points_;
  std::optional<MappingSummary> mapping_;  // where it is on
  evaluation::Trajectory trajectory_;      // T_map_base
  std::string compared_filter_;
  std::optional<Run> compared_;
};

}  // namespace slamd::replay
