#pragma once

#include <cstdint>

#include "core/graph/normal_equations.hpp"
#include "core/graph/pose_graph.hpp"

namespace slamd::graph {

/// When the optimiser stops.
struct OptimiserLimits {
  int max_iterations = 20;
  double step_m = 1e-3;    // no pose moved farther in its last step
  double step_rad = 1e-4;
};

/// How it went.
enum class OptimiserEnd : std::uint8_t {
  kConverged,       // the last step was below the limits
  kIterations,      // they were used up; the poses are the best so far
  kNoDescent,       // no damping finds a smaller sum; the poses are the best so far
  kFactorTooLarge,  // the factorisation does not fit its memory; nothing was changed
};

struct OptimiserResult {
  OptimiserEnd end = OptimiserEnd::kConverged;
  int iterations = 0;  // factorisations
  double cost = 0.0;
};

/// Gauss–Newton on a pose graph, damped as Levenberg and Marquardt do once a step does not lower the sum.
/// Real-time: one structure analysis whenever what is tied to what has changed; see NormalEquations for the memory.
class Optimiser {
 public:
  explicit Optimiser(const NormalEquationsCapacity& capacity) : equations_(capacity) {}

  /// Orders and lays out the equations if the graph's structure is new. Returns false where the factorisation does not fit.
  bool prepare(const PoseGraph& graph);

  /// Moves the poses towards the least sum.
  OptimiserResult run(PoseGraph& graph, const OptimiserLimits& limits);

  const NormalEquations& equations() const { return equations_; }

 private:
  NormalEquations equations_;
  const PoseGraph* analysed_graph_ = nullptr;
  std::uint64_t analysed_version_ = 0;
};

}  // namespace slamd::graph
