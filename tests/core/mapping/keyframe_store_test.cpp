#include "core/mapping/keyframe_store.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace slamd::mapping {
namespace {

using geometry::Se3;

Se3 at(double x, double y, double yaw_rad) {
  return {Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix(), {x, y, 0.0}};
}

struct KeyframeStoreTest : testing::Test {
  void add(double x, double y, double yaw_rad) {
    Keyframe keyframe;
    keyframe.id = static_cast<graph::KeyframeId>(poses.size());
    poses.push_back(at(x, y, yaw_rad));
    const std::vector<Eigen::Vector3f> cloud(keyframe.id + 1, Eigen::Vector3f(1.0F, 0.0F, 0.0F));
    EXPECT_TRUE(sut.add(keyframe, cloud));
  }

  std::optional<std::size_t> redundant(std::size_t kept) {
    return sut.most_redundant(kept, [&](std::size_t i) -> const Se3& { return poses[i]; });
  }

  KeyframeStore sut{6, 100};
  std::vector<Se3> poses;
};

TEST_F(KeyframeStoreTest, RefusesMoreThanItHolds) {
  for (int i = 0; i < 6; ++i) {
    add(20.0 * i, 0.0, 0.0);
  }
  Keyframe seventh;
  seventh.id = 6;

  EXPECT_TRUE(sut.full());
  EXPECT_FALSE(sut.add(seventh, {}));
}

TEST_F(KeyframeStoreTest, NamesTheOlderOfTheNearestTwoThatLookTheSameWay) {
  add(0.0, 0.0, 0.0);
  add(5.0, 0.0, 0.0);
  add(10.0, 0.0, 0.0);
  add(10.2, 0.0, 3.1);  // nearer to the third, but looks back
  add(5.5, 0.0, 0.1);
  add(30.0, 0.0, 0.0);

  EXPECT_EQ(redundant(1), 1U);
}

TEST_F(KeyframeStoreTest, KeepsTheFirstAndTheNewest) {
  add(0.0, 0.0, 0.0);
  add(0.1, 0.0, 0.0);
  add(20.0, 0.0, 0.0);
  add(40.0, 0.0, 0.0);
  add(40.2, 0.0, 0.0);
  add(40.3, 0.0, 0.0);

  EXPECT_EQ(redundant(3), 1U) << "not the first, and not among the last three";
}

TEST_F(KeyframeStoreTest, NamesTheOldestButTheFirstWhereNoneIsLikeAnother) {
  for (int i = 0; i < 6; ++i) {
    add(20.0 * i, 0.0, 0.0);
  }

  EXPECT_EQ(redundant(2), 1U);
}

TEST_F(KeyframeStoreTest, MovesUpAfterOneIsTakenOutAndFreesItsCloud) {
  for (int i = 0; i < 6; ++i) {
    add(20.0 * i, 0.0, 0.0);
  }

  sut.erase(2);
  Keyframe seventh;
  seventh.id = 6;

  EXPECT_EQ(sut[2].id, 3U);
  EXPECT_EQ(sut.cloud_points(2), 4U);
  EXPECT_TRUE(sut.add(seventh, std::vector<Eigen::Vector3f>(50, Eigen::Vector3f::Zero())));
  EXPECT_EQ(sut.cloud_points(5), 50U);
}

TEST(Level, TurnsUpToZAndKeepsTheHeading) {
  const Eigen::Vector3d up_base = Eigen::Vector3d(0.1, -0.05, 1.0).normalized();

  const Eigen::Matrix3d R_base_level = level_of(up_base);

  EXPECT_TRUE((R_base_level.transpose() * up_base).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_NEAR(R_base_level(1, 0), 0.0, 0.01);
}

}  // namespace
}  // namespace slamd::mapping
