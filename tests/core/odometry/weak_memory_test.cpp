#include "core/odometry/weak_memory.hpp"

#include <gtest/gtest.h>

namespace slamd::odometry {
namespace {

using geometry::Se3;

constexpr double kSharp = 0.95;
constexpr double kBlurred = 0.7;

class DriveThroughATunnel : public ::testing::Test {
 protected:
  /// Drives ahead by 0.2 m a scan, turning by so much in each.
  void drive(int scans, bool weak, double fit, double turn_rad = 0.0, double share = 0.03) {
    Localisability seen;
    seen.own_weak = weak ? 1 : 0;
    seen.weakest_odom = weak_odom;
    seen.remembered_share = share;
    for (int i = 0; i < scans; ++i) {
      const Eigen::Matrix3d turn = geometry::so3_exp(Eigen::Vector3d(0.0, 0.0, turn_rad));
      T_odom_base = T_odom_base * Se3(turn, Eigen::Vector3d(0.2, 0.0, 0.0));
      sut.note(seen, fit, T_odom_base);
    }
  }

  WeakMemory sut;
  Se3 T_odom_base;
  Eigen::Vector3d weak_odom = Eigen::Vector3d::UnitX();
};

TEST_F(DriveThroughATunnel, IsNotRememberedAfterAFewMetres) {
  drive(50, true, kSharp);

  EXPECT_FALSE(sut.direction_odom());
}

TEST_F(DriveThroughATunnel, IsRememberedWhenTheMapSeemsToShowTheWay) {
  drive(150, true, kSharp);
  drive(500, false, kBlurred);

  ASSERT_TRUE(sut.direction_odom());
  EXPECT_NEAR(sut.direction_odom()->x(), 1.0, 1e-9);
}

TEST_F(DriveThroughATunnel, IsOverWhenScansThatFitHaveSeenTheWayForAWhile) {
  drive(150, true, kSharp);
  drive(WeakMemory::kFittingScans - 1, false, kSharp);
  EXPECT_TRUE(sut.direction_odom());

  drive(1, false, kSharp);

  EXPECT_FALSE(sut.direction_odom());
}

TEST_F(DriveThroughATunnel, IsOverWhenTheWayIsClearWhateverTheMapIsLike) {
  drive(150, true, kSharp);
  drive(WeakMemory::kFittingScans, false, kBlurred, 0.0, 0.3);

  EXPECT_FALSE(sut.direction_odom());
}

TEST_F(DriveThroughATunnel, TurnsWithAGentleBendAndNotWithAVehicleThatTurnsAbout) {
  drive(150, true, kSharp);
  drive(100, false, kBlurred, 0.001);
  EXPECT_NEAR(sut.direction_odom()->y(), std::sin(0.1), 1e-6);

  drive(20, false, kBlurred, 0.15);

  EXPECT_NEAR(sut.direction_odom()->y(), std::sin(0.1), 1e-6);
}

TEST_F(DriveThroughATunnel, KeepsItsDirectionWhereABlurredMapNamesAnother) {
  drive(150, true, kSharp);
  weak_odom = Eigen::Vector3d::UnitY();
  drive(20, true, kBlurred);

  EXPECT_NEAR(sut.direction_odom()->x(), 1.0, 1e-9);
}

}  // namespace
}  // namespace slamd::odometry
