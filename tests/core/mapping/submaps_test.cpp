#include "core/mapping/submaps.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamd::mapping {
namespace {

using geometry::Se3;

Se3 at(double x) { return {Eigen::Matrix3d::Identity(), {x, 0.3, 0.0}}; }

TEST(Submaps, BeginsANewOneEachLengthOfTheWay) {
  Submaps sut(10, 20.0);

  EXPECT_EQ(sut.add_keyframe(0, 0.0, at(0.0), Se3()), 0U);
  EXPECT_EQ(sut.add_keyframe(1, 19.0, at(19.0), Se3()), 0U);
  EXPECT_EQ(sut.add_keyframe(2, 20.0, at(20.0), Se3()), 1U);
  EXPECT_EQ(sut.size(), 2U);
}

TEST(Submaps, AnchorsThemOnWholeBlocks) {
  Submaps sut(10, 20.0);

  sut.add_keyframe(0, 0.0, at(12.34), Se3());

  const Eigen::Vector3d blocks = sut[0].anchor_odom / Submaps::kBlock_m;
  EXPECT_TRUE(blocks.isApprox(blocks.array().round().matrix(), 1e-9));
  EXPECT_LT((sut[0].anchor_odom - at(12.34).translation()).norm(), Submaps::kBlock_m);
}

TEST(Submaps, CountAVersionForEachMoveAndNoneForStandingStill) {
  Submaps sut(10, 20.0);
  sut.add_keyframe(0, 0.0, at(0.0), Se3());

  EXPECT_FALSE(sut.place(0, Se3()));
  EXPECT_TRUE(sut.place(0, at(0.5)));
  EXPECT_FALSE(sut.place(0, at(0.5)));

  EXPECT_EQ(sut[0].version, 1U);
  EXPECT_TRUE(sut[0].T_map_submap.translation().isApprox(at(0.5).translation() + sut[0].anchor_odom));
}

TEST(Submaps, EndsWithItsLastKeyframeAndKeepsTheOthersIds) {
  Submaps sut(3, 1.0);
  sut.add_keyframe(0, 0.0, at(0.0), Se3());
  sut.add_keyframe(1, 5.0, at(5.0), Se3());
  sut.add_keyframe(2, 10.0, at(10.0), Se3());

  sut.remove_keyframe(1);
  const std::uint32_t fourth = sut.add_keyframe(3, 15.0, at(15.0), Se3());

  EXPECT_EQ(fourth, 3U);
  ASSERT_EQ(sut.size(), 3U);
  EXPECT_EQ(sut[1].id, 2U);
}

}  // namespace
}  // namespace slamd::mapping
