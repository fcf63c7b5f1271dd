#pragma once

#include <cmath>

namespace slamd::graph {

/// Truncated least squares, min(r², c̄²), made convex by µ and led back to itself as µ grows.
/// All squared residuals here are r²/c̄², so that factors of different dimension share one µ.
/// Source: graduated non-convexity, [Yang20] (arXiv 1909.08605), Eq. (12) to (14) and Remark 5.

/// Returns the µ at which even the worst residual lies where the surrogate is convex.
inline double first_mu(double worst_ratio) {
  return worst_ratio > 0.5 ? 1.0 / (2.0 * worst_ratio - 1.0) : 1e6;
}

/// Returns a factor's weight: 1 well inside the truncation, 0 well outside, c̄√(µ(µ+1))/r − µ between.
inline double truncated_weight(double ratio, double mu) {
  if (ratio <= mu / (mu + 1.0)) {
    return 1.0;
  }
  if (ratio >= (mu + 1.0) / mu) {
    return 0.0;
  }
  return std::sqrt(mu * (mu + 1.0) / ratio) - mu;
}

}  // namespace slamd::graph
