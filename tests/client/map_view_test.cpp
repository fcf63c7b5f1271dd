#include "client/map_view.hpp"

#include <gtest/gtest.h>

namespace slamd::client {
namespace {

TEST(MapView, AnswersEverythingBeforeThereIsAMap) {
  const MapView sut;
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const Eigen::Vector3d goal(3.0, 2.0, 1.0);

  EXPECT_FALSE(sut.known());
  EXPECT_FALSE(sut.complete());
  EXPECT_EQ(sut.cells().size(), 0U);
  EXPECT_EQ(sut.at(origin), MapView::CellState::kUnknown);
  EXPECT_FALSE(sut.is_current(origin));
  EXPECT_EQ(sut.count(origin, goal).unknown, 16U * 11U * 6U);
  EXPECT_TRUE(sut.cast(origin, goal));
  EXPECT_FALSE(sut.cast(origin, goal, false));
  EXPECT_FALSE(sut.nearest(origin, 10.0));
  EXPECT_EQ(sut.to_map(goal), goal);
  EXPECT_EQ(sut.submap(0), nullptr);
}

}  // namespace
}  // namespace slamd::client
