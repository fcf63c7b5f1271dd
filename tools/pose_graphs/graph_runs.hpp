#pragma once

#include <cstddef>

#include "core/graph/back_end.hpp"
#include "tools/pose_graphs/synthetic_graph.hpp"

namespace slamd::pose_graphs {

/// What became of the loops of a synthetic drive.
struct RunResult {
  std::size_t true_loops = 0;
  std::size_t true_kept = 0;    // in the final graph
  std::size_t false_loops = 0;
  std::size_t false_passed = 0; // the gates before the graph
  std::size_t false_kept = 0;   // in the final graph
  double odometry_error_m = 0.0;
  double error_m = 0.0;         // positions, RMS
  EarthError earth;             // with fixes
  bool aligned = false;
  std::size_t warm = 0;
  std::size_t full = 0;
  double warm_max_ms = 0.0;
  double full_max_ms = 0.0;
  double other_max_ms = 0.0;    // updates that moved nothing
};

/// Drives a back end through a synthetic drive, keyframe by keyframe, as the daemon's mapping thread would.
RunResult run_back_end(const SyntheticGraph& drive);

/// Gives graduated non-convexity all loops and fixes at once, with no gate before it. full_max_ms is its time.
RunResult run_gnc(const SyntheticGraph& drive, bool with_gnss);

/// The cost of the solver on one core.
struct SpeedResult {
  std::size_t keyframes = 0;
  std::size_t loops = 0;
  std::size_t factor_entries = 0;
  double analysis_ms = 0.0;         // of a new structure
  double iteration_ms = 0.0;        // linearise, factorise, solve, move, sum
  int iterations = 0;               // to convergence from the odometry
  double solve_ms = 0.0;            // of all of them
  double ceres_iteration_ms = 0.0;  // 0 where Ceres is absent
  int ceres_iterations = 0;
  double ceres_solve_ms = 0.0;
};

/// Times the optimum of a drive with true loops only, by slamd and by Ceres from the same poses.
SpeedResult measure_speed(const SyntheticGraph& drive);

}  // namespace slamd::pose_graphs
