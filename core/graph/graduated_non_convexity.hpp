#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/bounded_vector.hpp"
#include "core/graph/chi_squared.hpp"
#include "core/graph/optimiser.hpp"
#include "core/graph/pose_graph.hpp"

namespace slamd::graph {

/// What counts as an outlier, and how fast the truncation closes in on it.
struct GncConfig {
  double loop_chi_squared = kChiSquared999Of6;  // c̄² of loops: what is above counts no further
  double fix_chi_squared = kChiSquared99Of3;   // c̄² of fixes
  double mu_step = 2.0;                        // 1.4 in [Yang20]: the same loops kept in twice the time
  int max_rounds = 100;
};

/// How a run went.
struct GncResult {
  OptimiserEnd end = OptimiserEnd::kConverged;
  int rounds = 0;      // of the weights
  int iterations = 0;  // factorisations
  double cost = 0.0;   // with min(r², c̄²) of each loop and fix
};

/// Truncated least squares over loops and fixes by graduated non-convexity: odometry, gravity and priors are known to be
/// right, and of the rest the greatest part that agrees with them is sought from no first guess.
///
/// Begins from the odometry alone, so that the result depends on the factors and not on what was believed before.
/// Each round sets all weights from the residuals, goes one Gauss–Newton step and lowers the surrogate's convexity. Once all
/// weights are 0 or 1 the poses are brought to convergence and the weights judged by the truncation itself, until they stay.
/// Loops that are far out leave the equations on the way, for a wrong loop costs more fill than ten right ones; the last
/// judgement sees them again.
/// Source: [Yang20] (arXiv 1909.08605), Algorithm 1; one step a round and known inliers as in GTSAM's GncOptimizer.
/// Memory: sized once. Real-time: a hundred factorisations at most; mapping thread only.
class GraduatedNonConvexity {
 public:
  GraduatedNonConvexity(const PoseGraphCapacity& capacity, const GncConfig& config);

  /// Judges all enabled loops and all fixes anew; loops found wrong are no longer enabled. Where the factorisation does not
  /// fit nothing is changed.
  GncResult run(PoseGraph& graph, Optimiser& optimiser, const OptimiserLimits& limits);

  /// Brings the poses to convergence from where they are, with what agrees there and nothing else; loops and fixes are judged
  /// by the truncation, again and again until their weights stay. What run ends with.
  GncResult settle(PoseGraph& graph, Optimiser& optimiser, const OptimiserLimits& limits);

  /// Judges the fixes by the truncation at the present poses. Returns how many weights changed.
  std::size_t judge_fixes(PoseGraph& graph) const;

  /// Fits the alignment of the receiver's axes to the present poses; sets it where the motion tells the yaw well enough.
  /// Returns whether the graph has one.
  bool align(PoseGraph& graph, double least_extent_m, double greatest_yaw_std_rad);

 private:
  double loop_ratio(const PoseGraph& graph, std::size_t k) const {
    return graph.loop_chi_squared(k) / config_.loop_chi_squared;
  }
  double fix_ratio(const PoseGraph& graph, std::size_t i) const { return graph.fix_chi_squared(i) / config_.fix_chi_squared; }
  double worst_ratio(const PoseGraph& graph) const;
  bool set_weights(PoseGraph& graph, double mu) const;
  void leave_out_the_far(PoseGraph& graph, double mu) const;
  std::size_t judge_all(PoseGraph& graph);
  void remember_judged(const PoseGraph& graph);
  double truncated_cost(const PoseGraph& graph) const;
  void converge(PoseGraph& graph, Optimiser& optimiser, const OptimiserLimits& limits, GncResult& result);

  GncConfig config_;

  // scratch, sized once
  BoundedVector<std::uint8_t> judged_;  // by loop: whether it was enabled at the begin
  BoundedVector<AlignedPair> pairs_;
  BoundedVector<double> pair_weights_;
};

}  // namespace slamd::graph
