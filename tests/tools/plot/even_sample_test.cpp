#include "tools/plot/even_sample.hpp"

#include <gtest/gtest.h>

namespace slamd::plot {
namespace {

Eigen::Vector3f numbered(int i) {
  return {static_cast<float>(i), 0.0F, 0.0F};
}

TEST(EvenSample, KeepsEveryPointWhileThereIsRoom) {
  EvenSample sut(10);

  for (int i = 0; i < 10; ++i) {
    sut.offer(numbered(i));
  }

  ASSERT_EQ(sut.points().size(), 10U);
  EXPECT_EQ(sut.points().back().x(), 9.0F);
}

TEST(EvenSample, ReachesFromTheFirstPointToTheLastInEqualSteps) {
  for (const int capacity : {7, 8}) {
    EvenSample sut(static_cast<std::size_t>(capacity));

    for (int i = 0; i < 1001; ++i) {
      sut.offer(numbered(i));
    }

    ASSERT_LE(sut.points().size(), static_cast<std::size_t>(capacity));
    ASSERT_GE(sut.points().size(), static_cast<std::size_t>(capacity) / 2);
    const float step = sut.points()[1].x() - sut.points()[0].x();
    EXPECT_EQ(sut.points().front().x(), 0.0F);
    EXPECT_GT(sut.points().back().x() + step, 1000.0F);
    for (std::size_t i = 1; i < sut.points().size(); ++i) {
      EXPECT_EQ(sut.points()[i].x() - sut.points()[i - 1].x(), step);
    }
  }
}

}  // namespace
}  // namespace slamd::plot
