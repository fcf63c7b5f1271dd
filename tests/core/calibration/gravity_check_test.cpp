#include "core/base/units.hpp"
#include "core/calibration/gravity_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::calibration {
namespace {


/// Drives `way_m` in circles over ground that rises and falls, with base leaning against the vehicle by what is given.
GravityAgreement driven(double way_m, double roll_rad, double pitch_rad) {
  GravityCheck sut;
  geometry::Se3 T_odom_base;
  const Eigen::Matrix3d lean = geometry::rotation_from_rpy({roll_rad, pitch_rad, 0.0});
  for (double s = 0.0; s < way_m; s += 0.15) {
    T_odom_base.translation() += Eigen::Vector3d(0.15 * std::cos(0.1 * s), 0.15 * std::sin(0.1 * s), 0.0);
    const double slope = 0.05 * std::sin(0.4 * s);
    T_odom_base.rotation() = geometry::rotation_from_rpy({0.0, slope, 0.1 * s}) * lean;
    sut.add(T_odom_base, Eigen::Vector3d::UnitZ());
  }
  return sut.agreement();
}

TEST(GravityCheck, FindsALeanUnderSlopes) {
  const GravityAgreement agreement = driven(100.0, 5.0 * kDegree, -4.0 * kDegree);

  ASSERT_TRUE(agreement.known);
  EXPECT_NEAR(agreement.roll_rad.value, 5.0 * kDegree, 0.5 * kDegree);
  EXPECT_NEAR(agreement.pitch_rad.value, -4.0 * kDegree, 0.5 * kDegree);
  EXPECT_TRUE(agreement.roll_rad.stands_out(3.0 * kDegree));
  EXPECT_TRUE(agreement.pitch_rad.stands_out(3.0 * kDegree));
}

TEST(GravityCheck, TakesSlopesForNoLean) {
  const GravityAgreement agreement = driven(100.0, 0.0, 0.0);

  ASSERT_TRUE(agreement.known);
  EXPECT_FALSE(agreement.roll_rad.stands_out(0.5 * kDegree));
  EXPECT_FALSE(agreement.pitch_rad.stands_out(0.5 * kDegree));
}

TEST(GravityCheck, KnowsNothingOfAShortWay) { EXPECT_FALSE(driven(30.0, 5.0 * kDegree, 0.0).known); }

TEST(GravityCheck, TakesNoiseAtRestForNoWay) {
  GravityCheck sut;
  geometry::Se3 T_odom_base;
  for (int i = 0; i < 20'000; ++i) {
    T_odom_base.translation().x() = 0.005 * (i % 3);
    sut.add(T_odom_base, Eigen::Vector3d(0.2, 0.0, 0.98));
  }

  EXPECT_EQ(sut.agreement().way_m, 0.0);
}

}  // namespace
}  // namespace slamd::calibration
