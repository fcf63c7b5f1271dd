#pragma once

#include "core/base/bounded_vector.hpp"
#include "core/graph/chi_squared.hpp"
#include "core/graph/optimiser.hpp"
#include "core/graph/pose_graph.hpp"

namespace slamd::graph {

/// What counts as an outlier, and how fast the truncation closes in on it.
struct GncConfig {
  double loop_chi_squared = kChiSquared99Of6;  // c̄² of loops: what is above counts no further
  double fix_chi_squared = kChiSquared99Of3;   // c̄² of fixes
  double mu_step = 1.4;
  int max_rounds = 100;
};

/// How a run went.
struct GncResult {
  OptimiserEnd end = OptimiserEnd::kConverged;
  int rounds = 0;      // of the weights
  int iterations = 0;  // factorisations
  double cost = 0.0;
};

/// Truncated least squares over loops and fixes by graduated non-convexity: odometry, gravity and priors are known to be
/// right, and of the rest the greatest part that agrees with them is sought from no first guess.
///
/// Begins from the odometry alone, so that the result depends on the factors and not on what was believed before.
/// Each round sets all weights from the residuals, goes one Gauss–Newton step and lowers the surrogate's convexity. Once all
/// weights are 0 or 1 the poses are brought to convergence and the weights judged by the truncation itself, until they stay.
/// Source: [Yang20] (arXiv 1909.08605), Algorithm 1; one step a round and known inliers as in GTSAM's GncOptimizer.
/// Memory: sized once. Real-time: a hundred factorisations at most; mapping thread only.
class GraduatedNonConvexity {
 public:
  GraduatedNonConvexity(const PoseGraphCapacity& capacity, const GncConfig& config);

  /// Judges all enabled loops and all fixes anew. Where the factorisation does not fit nothing is changed.
  GncResult run(PoseGraph& graph, Optimiser& optimiser, const OptimiserLimits& limits);

  /// Judges by the truncation at the present poses: fixes both ways, loops only as told.
  /// Returns how many weights changed.
  std::size_t judge(PoseGraph& graph, bool loops_too);

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

  GncConfig config_;

  // scratch, sized once
  BoundedVector<AlignedPair> pairs_;
  BoundedVector<double> pair_weights_;
};

}  // namespace slamd::graph
