#include "core/graph/graduated_non_convexity.hpp"

#include <algorithm>
#include <limits>

#include "core/graph/truncated_least_squares.hpp"

namespace slamd::graph {

namespace {

constexpr double kSettled = 0.99;
constexpr int kMaxJudgements = 5;
constexpr double kFar = 4.0;        // in squared residuals beyond where the weight is 0
constexpr std::size_t kFewest = 4;  // loops that are worth leaving out

}  // namespace

GraduatedNonConvexity::GraduatedNonConvexity(const PoseGraphCapacity& capacity, const GncConfig& config)
    : config_(config), judged_(capacity.loops), pairs_(capacity.keyframes), pair_weights_(capacity.keyframes) {}

double GraduatedNonConvexity::worst_ratio(const PoseGraph& graph) const {
  double worst = 0.0;
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    if (graph.loop(k).enabled) {
      worst = std::max(worst, loop_ratio(graph, k));
    }
  }
  for (std::size_t i = 0; graph.alignment() && i < graph.size(); ++i) {
    if (graph.node(i).fix) {
      worst = std::max(worst, fix_ratio(graph, i));
    }
  }
  return worst;
}

bool GraduatedNonConvexity::set_weights(PoseGraph& graph, double mu) const {
  bool settled = true;
  const auto judged = [&](double ratio) {
    const double w = truncated_weight(ratio, mu);
    settled = settled && (w == 0.0 || w > kSettled);  // small ones are how it begins
    return w;
  };
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    if (graph.loop(k).enabled) {
      graph.set_loop_weight(k, judged(loop_ratio(graph, k)));
    }
  }
  for (std::size_t i = 0; graph.alignment() && i < graph.size(); ++i) {
    if (graph.node(i).fix) {
      graph.set_fix_weight(i, judged(fix_ratio(graph, i)));
    }
  }
  return settled;
}

void GraduatedNonConvexity::leave_out_the_far(PoseGraph& graph, double mu) const {
  const double far = kFar * (mu + 1.0) / mu;
  std::size_t enabled = 0;
  std::size_t out = 0;
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    enabled += graph.loop(k).enabled ? 1 : 0;
    out += graph.loop(k).enabled && loop_ratio(graph, k) > far ? 1 : 0;
  }
  if (out < kFewest || out * 20 < enabled) {
    return;  // not worth a new order of elimination
  }
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    if (graph.loop(k).enabled && loop_ratio(graph, k) > far) {
      graph.set_loop_enabled(k, false);
    }
  }
}

std::size_t GraduatedNonConvexity::judge_fixes(PoseGraph& graph) const {
  std::size_t changed = 0;
  for (std::size_t i = 0; graph.alignment() && i < graph.size(); ++i) {
    if (graph.node(i).fix) {
      const double w = fix_ratio(graph, i) <= 1.0 ? 1.0 : 0.0;
      changed += w == graph.node(i).fix_weight ? 0 : 1;
      graph.set_fix_weight(i, w);
    }
  }
  return changed;
}

std::size_t GraduatedNonConvexity::judge_all(PoseGraph& graph) {
  std::size_t changed = judge_fixes(graph);
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    if (judged_[k]) {
      const bool right = loop_ratio(graph, k) <= 1.0;
      changed += right == (graph.loop(k).enabled && graph.loop(k).weight == 1.0) ? 0 : 1;
      graph.set_loop_weight(k, right ? 1.0 : 0.0);
      graph.set_loop_enabled(k, right);
    }
  }
  return changed;
}

bool GraduatedNonConvexity::align(PoseGraph& graph, double least_extent_m, double greatest_yaw_std_rad) {
  pairs_.clear();
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const Node& node = graph.node(i);
    if (node.fix) {
      pairs_.push_back({node.T_map_base * node.fix->p_base_antenna, node.fix->p_enu, node.fix->horizontal_std_m,
                        node.fix->vertical_std_m});
    }
  }
  pair_weights_.resize(pairs_.size());
  const AlignmentEstimate estimate = fit_alignment(pairs_.view(), pair_weights_.view());
  if (estimate.extent_m < least_extent_m || estimate.yaw_std_rad > greatest_yaw_std_rad) {
    return graph.alignment().has_value();
  }
  graph.set_alignment(estimate.alignment);
  return true;
}

GncResult GraduatedNonConvexity::run(PoseGraph& graph, Optimiser& optimiser, const OptimiserLimits& limits) {
  GncResult result;
  if (!optimiser.prepare(graph)) {
    result.end = OptimiserEnd::kFactorTooLarge;
    return result;
  }
  remember_judged(graph);
  graph.unroll_odometry();
  if (graph.alignment()) {
    align(graph, 0.0, std::numeric_limits<double>::infinity());
  }
  const OptimiserLimits one_step{1, 0.0, 0.0};
  double mu = first_mu(worst_ratio(graph));
  bool settled = false;
  for (; !settled && result.rounds < config_.max_rounds; ++result.rounds, mu *= config_.mu_step) {
    settled = set_weights(graph, mu);
    result.iterations += optimiser.run(graph, one_step).iterations;
    leave_out_the_far(graph, mu);
  }
  converge(graph, optimiser, limits, result);
  return result;
}

GncResult GraduatedNonConvexity::settle(PoseGraph& graph, Optimiser& optimiser, const OptimiserLimits& limits) {
  GncResult result;
  remember_judged(graph);
  converge(graph, optimiser, limits, result);
  return result;
}

void GraduatedNonConvexity::remember_judged(const PoseGraph& graph) {
  judged_.resize(graph.loops());
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    judged_[k] = graph.loop(k).enabled;
  }
}

void GraduatedNonConvexity::converge(PoseGraph& graph,
                                     Optimiser& optimiser,
                                     const OptimiserLimits& limits,
                                     GncResult& result) {
  for (int k = 0; k < kMaxJudgements; ++k) {
    const std::size_t changed = judge_all(graph);
    if (k > 0 && changed == 0) {
      break;
    }
    const OptimiserResult polished = optimiser.run(graph, limits);
    result.iterations += polished.iterations;
    result.end = polished.end;
  }
  result.cost = truncated_cost(graph);
}

double GraduatedNonConvexity::truncated_cost(const PoseGraph& graph) const {
  double cost = graph.cost();
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    cost += judged_[k] && !graph.loop(k).enabled ? 0.5 * config_.loop_chi_squared : 0.0;
  }
  for (std::size_t i = 0; graph.alignment() && i < graph.size(); ++i) {
    cost += graph.node(i).fix && graph.node(i).fix_weight == 0.0 ? 0.5 * config_.fix_chi_squared : 0.0;
  }
  return cost;
}

}  // namespace slamd::graph
