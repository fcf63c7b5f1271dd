#include "tools/study/wilson_interval.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::study {

Interval wilson_interval(std::size_t hits, std::size_t n) {
  if (n == 0) {
    return {};
  }
  constexpr double kZ = 1.959963984540054;  // 95 %, two-sided
  const double count = static_cast<double>(n);
  const double share = static_cast<double>(hits) / count;
  const double scale = 1.0 / (1.0 + kZ * kZ / count);
  const double centre = scale * (share + kZ * kZ / (2.0 * count));
  const double half =
      scale * kZ * std::sqrt(share * (1.0 - share) / count + kZ * kZ / (4.0 * count * count));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

}  // namespace slamd::study
