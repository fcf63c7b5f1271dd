#include "tools/study/systematic_resampling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace slamd::study {
namespace {

TEST(SystematicResampling, IsUnbiased) {
  const std::vector<double> weights{0.05, 3.0, 0.0, 1.2, 0.75, 2.0, 0.3};
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<double> drawn(weights.size(), 0.0);
  constexpr int kOffsets = 10'000;

  for (int i = 0; i < kOffsets; ++i) {
    for (const std::size_t parent : systematic_resampling(weights, (i + 0.5) / kOffsets)) {
      drawn[parent] += 1.0 / kOffsets;
    }
  }

  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(drawn[i], weights[i] / sum * static_cast<double>(weights.size()), 1e-3) << i;
  }
}

TEST(SystematicResampling, GivesEachParentItsShareToWithinOneChild) {
  const std::vector<double> weights{1.0, 5.0, 2.5, 0.1, 9.4, 2.0};
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);

  for (const double offset : {0.0, 0.3, 0.999}) {
    std::vector<int> children(weights.size(), 0);
    for (const std::size_t parent : systematic_resampling(weights, offset)) {
      ++children[parent];
    }

    for (std::size_t i = 0; i < weights.size(); ++i) {
      EXPECT_LT(std::abs(children[i] - weights[i] / sum * static_cast<double>(weights.size())), 1.0)
          << i;
    }
  }
}

TEST(SystematicResampling, KeepsAllOfEqualWeight) {
  const std::vector<double> weights(5, 0.2);

  EXPECT_EQ(systematic_resampling(weights, 0.5), (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace slamd::study
