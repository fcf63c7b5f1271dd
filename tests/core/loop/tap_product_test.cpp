#include "core/loop/tap_product.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace slamd::loop {
namespace {

TEST(TapProduct, IsBitForBitThePlainSum) {
  constexpr std::size_t kTaps = 37;
  constexpr std::size_t kChannels = 12;
  constexpr std::size_t kWide = 48;
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  std::vector<float> rows(kTaps * (kWide + 3));
  std::vector<float> weights(kTaps * kChannels);
  std::generate(rows.begin(), rows.end(), [&] { return normal(random); });
  std::generate(weights.begin(), weights.end(), [&] { return normal(random); });
  std::vector<const float*> taps;
  for (std::size_t k = 0; k < kTaps; ++k) {
    taps.push_back(rows.data() + k * (kWide + 3) + k % 4);  // not aligned
  }
  std::vector<float> result(kChannels * kWide, -1.0F);
  std::vector<float> plain(kChannels * kWide, -2.0F);

  tap_product(taps, weights.data(), kChannels, kWide, result.data(), kWide);
  tap_product_plain(taps, weights.data(), kChannels, kWide, plain.data(), kWide);

  EXPECT_EQ(result, plain);
}

}  // namespace
}  // namespace slamd::loop
