#include "tools/study/wilson_interval.hpp"

#include <gtest/gtest.h>

namespace slamd::study {
namespace {

TEST(WilsonInterval, HasTheValuesOfTheLiterature) {
  const Interval tenth = wilson_interval(10, 100);
  const Interval half = wilson_interval(50, 100);
  const Interval newcombe = wilson_interval(81, 263);  // Newcombe (1998), table I, method 3

  EXPECT_NEAR(tenth.low, 0.0552, 1e-4);
  EXPECT_NEAR(tenth.high, 0.1744, 1e-4);
  EXPECT_NEAR(half.low, 0.4038, 1e-4);
  EXPECT_NEAR(half.high, 0.5962, 1e-4);
  EXPECT_NEAR(newcombe.low, 0.2553, 1e-4);
  EXPECT_NEAR(newcombe.high, 0.3662, 1e-4);
}

TEST(WilsonInterval, StaysOpenWhereNothingOrEverythingWasHit) {
  EXPECT_NEAR(wilson_interval(0, 100).low, 0.0, 1e-12);
  EXPECT_NEAR(wilson_interval(0, 100).high, 0.0370, 1e-4);
  EXPECT_NEAR(wilson_interval(100, 100).low, 0.9630, 1e-4);
  EXPECT_NEAR(wilson_interval(100, 100).high, 1.0, 1e-12);
}

TEST(WilsonInterval, KnowsNothingWithoutDraws) {
  EXPECT_EQ(wilson_interval(0, 0).low, 0.0);
  EXPECT_EQ(wilson_interval(0, 0).high, 1.0);
}

}  // namespace
}  // namespace slamd::study
