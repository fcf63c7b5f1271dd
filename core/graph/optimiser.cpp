#include "core/graph/optimiser.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::graph {

namespace {

constexpr double kFirstLambda = 1e-6;
constexpr double kGreatestLambda = 1e8;
constexpr double kLambdaStep = 10.0;
constexpr double kRounding = 1e-12;  // of the sum

}  // namespace

bool Optimiser::prepare(const PoseGraph& graph) {
  if (analysed_graph_ != &graph || analysed_version_ != graph.structure_version()) {
    graph.declare(equations_);
    analysed_graph_ = equations_.analyse() ? &graph : nullptr;
    analysed_version_ = graph.structure_version();
  }
  return analysed_graph_ != nullptr;
}

OptimiserResult Optimiser::run(PoseGraph& graph, const OptimiserLimits& limits) {
  OptimiserResult result;
  if (!prepare(graph)) {
    result.end = OptimiserEnd::kFactorTooLarge;
    result.cost = graph.cost();
    return result;
  }
  double lambda = 0.0;
  result.end = OptimiserEnd::kIterations;
  result.cost = graph.linearise(equations_);
  while (result.iterations < limits.max_iterations) {
    ++result.iterations;
    bool descends = equations_.solve(lambda);
    if (descends) {
      const auto [step_m, step_rad] = graph.move(equations_);
      const double cost = graph.cost();
      const bool small = std::isfinite(cost) && step_m < limits.step_m && step_rad < limits.step_rad;
      descends = cost <= result.cost * (1.0 + kRounding);
      if (descends) {
        result.cost = cost;
      } else {
        graph.restore();
      }
      if (small) {
        result.end = OptimiserEnd::kConverged;
        break;
      }
    }
    if (descends) {
      lambda = lambda > kFirstLambda ? lambda / kLambdaStep : 0.0;
      if (result.iterations < limits.max_iterations) {
        graph.linearise(equations_);
      }
    } else {
      lambda = std::max(kFirstLambda, lambda * kLambdaStep);
      if (lambda > kGreatestLambda) {
        result.end = OptimiserEnd::kNoDescent;
        break;
      }
    }
  }
  return result;
}

}  // namespace slamd::graph
