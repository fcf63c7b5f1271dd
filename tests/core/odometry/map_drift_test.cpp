#include "core/odometry/map_drift.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/geometry/so3.hpp"

namespace slamd::odometry {
namespace {

using geometry::Matrix6d;
using geometry::Se3;

/// A scan that holds each direction to 1 mm and 0.1 mrad, but for x, which it does not see.
Matrix6d blind_along_x() {
  Matrix6d information = Matrix6d::Zero();
  information.diagonal() << 0.0, 1e6, 1e6, 1e8, 1e8, 1e8;
  return information;
}

Matrix6d drift_over(double way_m, double median_range_m) {
  return map_drift(blind_along_x(), Se3{}, Matrix6d::Identity(), Se3(Eigen::Matrix3d::Identity(), {way_m, 0.0, 0.0}),
                   median_range_m);
}

TEST(MapDrift, IsThatOfTheScanOverAMedianRangeOfWay) {
  const Matrix6d sut = drift_over(8.0, 8.0);

  EXPECT_NEAR(sut(1, 1), kLaidShare * 1e-6, 0.02e-6);
  EXPECT_NEAR(sut(5, 5), kLaidShare * 1e-8, 0.02e-8);
  EXPECT_NEAR(drift_over(2.0, 8.0)(1, 1), 0.25 * sut(1, 1), 1e-12);
  EXPECT_EQ(drift_over(0.0, 8.0).norm(), 0.0);  // standing, nothing new is seen
}

TEST(MapDrift, IsBoundedAlongWhatTheScanDoesNotSee) {
  const Matrix6d sut = drift_over(8.0, 8.0);

  EXPECT_GT(sut(0, 0), 50.0 * sut(1, 1));
  EXPECT_LT(sut(0, 0), 0.001);
}

TEST(MapDrift, IsInTheAxesOfBase) {
  const Se3 T_odom_base(geometry::rotation_from_rpy({0.0, 0.0, M_PI / 2}), {5.0, 6.0, 0.0});

  const Matrix6d sut = map_drift(blind_along_x(), T_odom_base, Matrix6d::Identity(),
                                 Se3(Eigen::Matrix3d::Identity(), {1.0, 0.0, 0.0}), 5.0);

  EXPECT_GT(sut(1, 1), 50.0 * sut(0, 0));  // odom's x is base's right
}

TEST(WithTrueNoise, ShrinksWhatTheScanHoldsAndKeepsWhatItDoesNotSee) {
  const Matrix6d H = blind_along_x();
  const Matrix6d P_prior = 1e-2 * Matrix6d::Identity();
  Eigen::Matrix<double, inertial::kFilterStates, 6> P_pose = Eigen::Matrix<double, inertial::kFilterStates, 6>::Zero();
  P_pose.topRows<6>() = (P_prior.inverse() + H).inverse();

  const auto sut = with_true_noise(P_pose, H);

  EXPECT_NEAR(sut(0, 0), P_prior(0, 0), 1e-12);
  EXPECT_NEAR(sut(1, 1), kTrueNoiseShare * P_pose(1, 1), 0.01 * P_pose(1, 1));
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(sut.topRows<6>()).eigenvalues().minCoeff(), 0.0);
}

TEST(BlindWay, IsTheShareOfTheStepAlongWeakDirectionsOnly) {
  registration::WeakDirections weak;
  weak.odom[0] = Eigen::Vector3d(0.6, 0.8, 0.0);
  weak.count = 1;

  EXPECT_TRUE(blind_way(weak, {1.2, 1.6, 0.5}, 0.03).isApprox(Eigen::Vector3d(0.036, 0.048, 0.0)));
  EXPECT_TRUE(blind_way(weak, {-0.8, 0.6, 0.5}, 0.03).isZero(1e-12));
  EXPECT_TRUE(blind_way({}, {1.2, 1.6, 0.5}, 0.03).isZero());
}

TEST(SurroundingsDrift, StaysBoundedOverAnyWay) {
  SurroundingsDrift sut;
  Se3 last;
  for (int i = 0; i < 2000; ++i) {
    const Se3 next(Eigen::Matrix3d::Identity(), last.translation() + Eigen::Vector3d(0.1, 0.0, 0.0));
    sut.add(last, next, 1e-6 * Matrix6d::Identity(), {0.001, 0.0, 0.0});
    last = next;
  }

  EXPECT_NEAR(sut.covariance()(5, 5), 1e-6 * kSurroundings_m / 0.1, 2e-6);  // 10 m of steps of 0.1 m
  EXPECT_LT(sut.covariance()(1, 1), 0.1);
  EXPECT_NEAR(std::sqrt(sut.covariance()(0, 0)), 0.1, 0.01);  // a hundredth of the same way
}

}  // namespace
}  // namespace slamd::odometry
