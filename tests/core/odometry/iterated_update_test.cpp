#include "core/odometry/iterated_update.hpp"

#include <gtest/gtest.h>

namespace slamd::odometry {
namespace {

using inertial::kPosition;
using inertial::kRotation;
using inertial::kVelocity;

geometry::Se3 at(double x_m) { return geometry::Se3(Eigen::Matrix3d::Identity(), {x_m, 0.0, 0.0}); }

inertial::Covariance known_to_millimetres() { return 1e-6 * inertial::Covariance::Identity(); }

TEST(WidenWhereExcluded, LeavesAPriorAloneThatAllowsThePose) {
  inertial::Covariance P = known_to_millimetres();

  widen_where_excluded({}, at(0.002), P);

  EXPECT_EQ(P, known_to_millimetres());
}

TEST(WidenWhereExcluded, DoubtsEveryDirectionAsMuchAsTheOneThatWasSeenToBeWrong) {
  inertial::Covariance P = known_to_millimetres();

  widen_where_excluded({}, at(0.8), P);

  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(P(kPosition + axis, kPosition + axis), 0.64, 1e-5);
    EXPECT_NEAR(P(kRotation + axis, kRotation + axis), 0.0, 1e-5);
  }
}

TEST(WidenWhereExcluded, TakesAFarPoseForAKnockAndNotForAGreatSpeed) {
  inertial::Covariance near = known_to_millimetres();
  inertial::Covariance far = known_to_millimetres();

  widen_where_excluded({}, at(0.02), near);
  widen_where_excluded({}, at(0.8), far);

  EXPECT_NEAR(near(kVelocity, kVelocity), 0.04, 1e-5);
  EXPECT_NEAR(far(kVelocity, kVelocity), 0.25, 1e-5);
  EXPECT_NEAR(far(kVelocity + 1, kVelocity + 1), 0.0, 1e-5);
}

}  // namespace
}  // namespace slamd::odometry
