#include "tools/plot/axes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tools/plot/svg.hpp"

namespace slamd::plot {
namespace {

TEST(Range, TakesInOnlyFiniteValues) {
  Range sut;
  sut.include(2.0);
  sut.include(std::numeric_limits<double>::quiet_NaN());
  sut.include(std::numeric_limits<double>::infinity());
  sut.include(-1.0);

  EXPECT_EQ(sut.low, -1.0);
  EXPECT_EQ(sut.high, 2.0);
}

TEST(Range, IsGivenAWidthWhereItHasNone) {
  Range constant;
  constant.include(20.0);
  constant.widen(0.0);
  Range empty;
  empty.widen(0.0);

  EXPECT_LT(constant.low, 20.0);
  EXPECT_GT(constant.high, 20.0);
  EXPECT_GT(empty.size(), 0.0);
}

TEST(RoundTicks, AreOneTwoOrFiveTimesAPowerOfTenApart) {
  EXPECT_EQ(round_ticks({0.0, 100.0}, 5), (std::vector<double>{0, 20, 40, 60, 80, 100}));
  EXPECT_EQ(round_ticks({-0.7, 0.7}, 3), (std::vector<double>{-0.5, 0.0, 0.5}));
  EXPECT_EQ(round_ticks({3.0, 9.0}, 7), (std::vector<double>{3, 4, 5, 6, 7, 8, 9}));
}

TEST(RoundTicks, AreNoneWithoutARange) {
  EXPECT_TRUE(round_ticks({1.0, 1.0}, 5).empty());
}

TEST(TickText, HasTheDigitsThatItsStepNeeds) {
  EXPECT_EQ(tick_text(40.0, 20.0), "40");
  EXPECT_EQ(tick_text(0.05, 0.01), "0.05");
  EXPECT_EQ(tick_text(0.5, 0.5), "0.5");
  EXPECT_EQ(tick_text(-1e-17, 0.5), "0.0");
}

TEST(Axes, MapUpwards) {
  const Axes sut({10.0, 20.0, 100.0, 50.0}, {0.0, 10.0}, {-1.0, 1.0});

  EXPECT_DOUBLE_EQ(sut.px(5.0), 60.0);
  EXPECT_DOUBLE_EQ(sut.py(1.0), 20.0);
  EXPECT_DOUBLE_EQ(sut.py(-1.0), 70.0);
}

TEST(Escaped, LeavesNoMarkupInTexts) {
  EXPECT_EQ(escaped("<a b=\"1\">&'"), "&lt;a b=&quot;1&quot;&gt;&amp;&#39;");
}

TEST(Coordinate, IsShort) {
  EXPECT_EQ(coordinate(1.0), "1");
  EXPECT_EQ(coordinate(1.256), "1.26");
  EXPECT_EQ(coordinate(100.0), "100");
  EXPECT_EQ(coordinate(-0.001), "0");
}

}  // namespace
}  // namespace slamd::plot
