#include "daemon/stages/pose_stage.hpp"

#include <gtest/gtest.h>

#include "core/geometry/so3.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::stages {
namespace {

using sensor::ImuSample;

constexpr auto kStep = std::chrono::milliseconds(5);
constexpr auto kScan = std::chrono::milliseconds(100);

/// At constant speed along x, level: what the sensor says.
ImuSample sample(int k) { return {Stamp{} + k * kStep, {0.0, 0.0, 0.0}, {0.0, 0.0, inertial::kGravityMps2}}; }

Anchor anchor(int k, double x_m, double speed_mps = 1.0) {
  Anchor result;
  result.state.stamp = Stamp{} + k * kStep;
  result.state.T_odom_imu = {Eigen::Matrix3d::Identity(), Eigen::Vector3d(x_m, 0.0, 0.0)};
  result.state.v_odom_imu = {speed_mps, 0.0, 0.0};
  result.P = inertial::Covariance::Identity() * 1e-4;
  result.odometry_state = odometry::State::kTracking;
  result.cause = odometry::Cause::kNone;
  return result;
}

odometry::OdometryConfig config() { return {}; }

TEST(PoseStage, SaysNothingBeforeTheFirstAnchor) {
  PoseStage sut(config(), kScan);
  EXPECT_FALSE(sut.add_imu(sample(1)));
  EXPECT_FALSE(sut.at_anchor());
}

TEST(PoseStage, GoesOnFromTheAnchorWithEverySample) {
  PoseStage sut(config(), kScan);
  sut.add_imu(sample(0));
  sut.add_anchor(anchor(0, 2.0));

  const auto pose = sut.add_imu(sample(1));

  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->stamp, sample(1).stamp);
  EXPECT_NEAR(pose->T_odom_base.translation().x(), 2.005, 1e-9);
  EXPECT_NEAR(pose->v_odom_base.x(), 1.0, 1e-9);
  EXPECT_EQ(pose->state, odometry::State::kTracking);
}

TEST(PoseStage, SaysWhenItGoesOnWithoutScans) {
  PoseStage sut(config(), kScan);
  sut.add_imu(sample(0));
  sut.add_anchor(anchor(0, 0.0));
  const auto last_in_time = static_cast<int>(PoseStage::kNoScan / kStep);
  std::optional<PredictedPose> pose;
  for (int k = 1; k <= last_in_time; ++k) {
    pose = sut.add_imu(sample(k));
  }
  EXPECT_EQ(pose->state, odometry::State::kTracking);

  pose = sut.add_imu(sample(last_in_time + 1));

  EXPECT_EQ(pose->state, odometry::State::kDegraded);
  EXPECT_EQ(pose->cause, odometry::Cause::kNoLidar);
}

TEST(PoseStage, DoesNotFlyAwayOverATimeOfWhichNobodyTells) {
  PoseStage sut(config(), kScan);
  sut.add_imu(sample(0));
  sut.add_anchor(anchor(0, 2.0, 0.0));
  ImuSample after = sample(60 * 200);
  after.angular_rate_radps.z() = 0.01;  // noise
  after.specific_force_mps2.x() = 0.05;

  EXPECT_FALSE(sut.add_imu(after));  // it could be a wild stamp
  after.stamp += std::chrono::milliseconds(5);
  const auto pose = sut.add_imu(after);

  ASSERT_TRUE(pose);
  EXPECT_NEAR((pose->T_odom_base.translation() - Eigen::Vector3d(2.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_GT(pose->P_odom_base(0, 0), 100.0);
  EXPECT_EQ(pose->cause, odometry::Cause::kNoLidar);
}

TEST(PoseStage, DoesNotFlyAwayByAnAnchorThatLiesBeforeSuchATime) {
  PoseStage sut(config(), kScan);
  sut.add_imu(sample(0));
  sut.add_anchor(anchor(0, 2.0, 0.0));
  ImuSample after = sample(60 * 200);
  after.specific_force_mps2.x() = 0.05;
  sut.add_imu(after);

  sut.add_anchor(anchor(20, 2.0, 0.0));
  const auto pose = sut.add_imu(sample(60 * 200 + 1));

  ASSERT_TRUE(pose);
  EXPECT_LT((pose->T_odom_base.translation() - Eigen::Vector3d(2.0, 0.0, 0.0)).norm(), 0.01);
  EXPECT_EQ(pose->reset_counter, 0U);
}

TEST(PoseStage, CatchesUpWithSamplesThatAreNewerThanALateAnchor) {
  PoseStage sut(config(), kScan);
  for (int k = 0; k <= 10; ++k) {
    sut.add_imu(sample(k));
  }
  sut.add_anchor(anchor(0, 0.0));

  const auto pose = sut.add_imu(sample(11));

  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->T_odom_base.translation().x(), 0.055, 1e-9);
}

TEST(PoseStage, BlendsASmallCorrectionOverOneScan) {
  PoseStage sut(config(), kScan);
  sut.add_imu(sample(0));
  sut.add_anchor(anchor(0, 0.0));
  double last_x = 0.0;
  for (int k = 1; k <= 25; ++k) {
    last_x = sut.add_imu(sample(k))->T_odom_base.translation().x();
  }
  sut.add_anchor(anchor(20, 0.100 + 0.02));  // 2 cm farther than predicted

  double largest_step = 0.0;
  std::optional<PredictedPose> pose;
  for (int k = 26; k <= 46; ++k) {
    pose = sut.add_imu(sample(k));
    largest_step = std::max(largest_step, pose->T_odom_base.translation().x() - last_x);
    last_x = pose->T_odom_base.translation().x();
  }

  EXPECT_LT(largest_step, 0.005 + 0.02 / 10.0);
  EXPECT_NEAR(last_x, 46 * 0.005 + 0.02, 1e-6);
  EXPECT_EQ(pose->reset_counter, 0U);
}

TEST(PoseStage, CountsACorrectionThatIsLargerThanItsUncertainty) {
  PoseStage sut(config(), kScan);
  sut.add_imu(sample(0));
  sut.add_anchor(anchor(0, 0.0));
  sut.add_imu(sample(1));
  sut.add_anchor(anchor(1, 0.5));

  const auto pose = sut.add_imu(sample(2));

  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->T_odom_base.translation().x(), 0.505, 1e-9);
  EXPECT_EQ(pose->reset_counter, 1U);
}

TEST(PoseStage, CountsANewOdomAsAJumpHoweverSmallItIs) {
  PoseStage sut(config(), kScan);
  sut.add_imu(sample(0));
  sut.add_anchor(anchor(0, 0.0));
  sut.add_imu(sample(1));
  Anchor of_another_odom = anchor(1, 0.006);
  of_another_odom.epoch = 2;
  sut.add_anchor(of_another_odom);

  const auto pose = sut.add_imu(sample(2));

  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->T_odom_base.translation().x(), 0.011, 1e-9);
  EXPECT_EQ(pose->reset_counter, 1U);
}

TEST(PoseStage, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  PoseStage sut(config(), kScan);
  sut.add_imu(sample(0));
  sut.add_anchor(anchor(0, 0.0));

  const std::size_t allocations = support::count_allocations([&] {
    for (int k = 1; k <= 100; ++k) {
      sut.add_imu(sample(k));
      if (k % 20 == 0) {
        sut.add_anchor(anchor(k - 5, 0.005 * (k - 5)));
      }
    }
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::stages
