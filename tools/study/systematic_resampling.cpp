#include "tools/study/systematic_resampling.hpp"

#include <numeric>

namespace slamd::study {

std::vector<std::size_t> systematic_resampling(std::span<const double> weights, double offset) {
  const double step =
      std::accumulate(weights.begin(), weights.end(), 0.0) / static_cast<double>(weights.size());
  std::vector<std::size_t> parents;
  std::size_t parent = 0;
  double cumulative = weights[0];
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double tooth = (static_cast<double>(i) + offset) * step;
    while (tooth >= cumulative && parent + 1 < weights.size()) {
      cumulative += weights[++parent];
    }
    parents.push_back(parent);
  }
  return parents;
}

}  // namespace slamd::study
