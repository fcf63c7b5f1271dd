#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace slamd::evaluation {

/// Returns the upper median: a value that occurs, of two middle ones the larger; NaN of none. What is quoted of a table's
/// cells; Statistics has the mean of the two.
inline double median_of(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace slamd::evaluation
