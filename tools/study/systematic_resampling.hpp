#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace slamd::study {

/// Draws as many parents as there are weights with one random number: a comb of equal steps over
/// the cumulative weights. `offset` in [0, 1). Source: Kitagawa (1996); Arulampalam et al. (2002),
/// algorithm 2. The product resamples multinomially, as [Liu22] does.
std::vector<std::size_t> systematic_resampling(std::span<const double> weights, double offset);

}  // namespace slamd::study
