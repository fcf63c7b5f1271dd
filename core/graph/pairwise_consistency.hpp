#pragma once

#include <cstddef>

#include "core/graph/chi_squared.hpp"
#include "core/graph/odometry_chain.hpp"

namespace slamd::graph {

/// A loop between keyframes by their places along the chain, i < j.
struct ChainLoop {
  std::size_t i = 0;
  std::size_t j = 0;
  Motion motion;  // T_i_j
};

/// How the way round a cycle of loops and odometry fails to close.
struct CycleError {
  double chi_squared = 0.0;     // of six dimensions
  double position_std_m = 0.0;  // by how much it may fail to close along its least certain direction, 1σ
};

/// Returns the error of i → j by the loop and j → i by the odometry.
CycleError odometry_cycle(const OdometryChain& chain, const ChainLoop& loop);

/// Returns the error of i → j by the first loop, j → l by the odometry, l → k by the second loop, k → i by the odometry.
/// The two ways of odometry count as independent, also where they overlap.
/// Source: pairwise consistency maximisation, [Mangelson18] Eq. (5); covariances to first order, as twists in base at i.
CycleError pair_cycle(const OdometryChain& chain, const ChainLoop& first, const ChainLoop& second);

}  // namespace slamd::graph
