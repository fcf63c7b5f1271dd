#pragma once

#include <cstddef>

namespace slamd::study {

/// An interval of a share, 0..1.
struct Interval {
  double low = 0.0;
  double high = 1.0;
};

/// Returns the 95 % score interval of a share of which `hits` of `n` were seen; honest at 0 and at
/// n, too. Source: Wilson (1927). n = 0: the whole of [0, 1].
Interval wilson_interval(std::size_t hits, std::size_t n);

}  // namespace slamd::study
