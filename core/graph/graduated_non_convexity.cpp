#include "core/graph/graduated_non_convexity.hpp"

#include <algorithm>
#include <limits>

#include "core/graph/truncated_least_squares.hpp"

namespace slamd::graph {

namespace {

constexpr double kSettled = 0.01;   // weights nearer to 0 or 1 than this no longer matter
constexpr int kMaxJudgements = 5;

}  // namespace

GraduatedNonConvexity::GraduatedNonConvexity(const PoseGraphCapacity& capacity, const GncConfig& config)
    : config_(config), pairs_(capacity.keyframes), pair_weights_(capacity.keyframes) {}

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
    settled = settled && (w < kSettled || w > 1.0 - kSettled);
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

std::size_t GraduatedNonConvexity::judge(PoseGraph& graph, bool loops_too) {
  std::size_t changed = 0;
  for (std::size_t k = 0; loops_too && k < graph.loops(); ++k) {
    if (graph.loop(k).enabled) {
      const double w = loop_ratio(graph, k) <= 1.0 ? 1.0 : 0.0;
      changed += w == graph.loop(k).weight ? 0 : 1;
      graph.set_loop_weight(k, w);
    }
  }
  for (std::size_t i = 0; graph.alignment() && i < graph.size(); ++i) {
    if (graph.node(i).fix) {
      const double w = fix_ratio(graph, i) <= 1.0 ? 1.0 : 0.0;
      changed += w == graph.node(i).fix_weight ? 0 : 1;
      graph.set_fix_weight(i, w);
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
  }
  for (int k = 0; k < kMaxJudgements; ++k) {
    const std::size_t changed = judge(graph, true);
    if (k > 0 && changed == 0) {
      break;
    }
    const OptimiserResult polished = optimiser.run(graph, limits);
    result.iterations += polished.iterations;
    result.end = polished.end;
    result.cost = polished.cost;
  }
  return result;
}

}  // namespace slamd::graph
