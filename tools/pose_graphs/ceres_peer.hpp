#pragma once

#include <optional>

#include "core/graph/pose_graph.hpp"

namespace slamd::pose_graphs {

/// What Ceres did to a pose graph.
struct CeresResult {
  int iterations = 0;   // linear solves
  double cost = 0.0;
  double cpu_s = 0.0;   // of the solve, without the problem's construction
};

/// Solves a pose graph by Ceres: the same sum with its present weights, written down a second time and differentiated
/// automatically; Levenberg–Marquardt on SuiteSparse's Cholesky, one thread. The poses and the alignment become Ceres's.
/// tolerance: of function, gradient and parameters. Returns nothing where slamd was built without Ceres.
std::optional<CeresResult> solve_with_ceres(graph::PoseGraph& graph, int max_iterations, double tolerance);

}  // namespace slamd::pose_graphs
