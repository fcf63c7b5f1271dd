#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/evaluation/trajectory.hpp"

namespace slamd::report {

/// One scan of a run.
struct ScanSample {
  evaluation::TimedPose pose;    // T_odom_base at the scan's end
  std::vector<double> stage_ms;  // CPU time, in the order of FilterRun::stages
  std::uint32_t particles = 0;   // 0: no swarm ran
  bool recovery_swarm = false;
  bool swarm_won = false;  // one of its modes replaced the plain update
  std::string state;       // TRACKING, DEGRADED, LOST, ...
  std::string cause;       // of the state, in words; empty: none
};

/// One filter's way through a recording.
struct FilterRun {
  std::string filter;               // psf, iekf
  std::vector<std::string> stages;  // names of the times in ScanSample::stage_ms
  std::vector<ScanSample> scans;
};

/// A value with its name, as it is to be read: {"real-time factor", "12.3"}.
struct Fact {
  std::string name;
  std::string value;
};

/// Counters of one kind: {"Packets", {{"received", 7540}, {"refused: short", 2}}}.
struct CounterGroup {
  std::string name;
  std::vector<std::pair<std::string, std::uint64_t>> counters;
};

/// What a report tells. The writer derives the rest: path length, accuracy, percentiles, spans of
/// states, pictures.
struct ReportContent {
  std::string recording;  // its name
  std::string made_with;  // program and version
  FilterRun run;
  std::optional<FilterRun> comparison;      // a second filter on the same recording
  std::optional<FilterRun> map_run;         // the run's poses corrected by loops: T_map_base; nothing where map is odom
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> loops;  // that the map believes: their ends, in map
  evaluation::Trajectory truth;             // T_world_base; may be empty
  std::vector<Eigen::Vector3f> map_points;  // in map
  std::vector<Fact> facts;                  // of the summary, beyond what the writer derives
  std::vector<CounterGroup> counters;
  std::vector<std::string> remarks;  // what a reader should know first
  std::string configuration;         // TOML
};

}  // namespace slamd::report
