#include "core/odometry/environment.hpp"

#include <algorithm>

namespace slamd::odometry {

EnvironmentEstimate::EnvironmentEstimate(Environment choice, double indoor_below_m, double outdoor_above_m)
    : choice_(choice),
      indoor_below_m_(indoor_below_m),
      outdoor_above_m_(outdoor_above_m),
      indoor_(choice == Environment::kIndoor) {}

void EnvironmentEstimate::add(float median_range_m) {
  if (choice_ != Environment::kAuto) {
    return;
  }
  ranges_m_[count_++ % ranges_m_.size()] = median_range_m;
  const std::size_t count = std::min(count_, ranges_m_.size());
  std::array<float, 10> sorted = ranges_m_;
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
  const double median_m = static_cast<double>(sorted[count / 2]);
  if (median_m < indoor_below_m_) {
    indoor_ = true;
  } else if (median_m > outdoor_above_m_) {
    indoor_ = false;
  }
}

}  // namespace slamd::odometry
