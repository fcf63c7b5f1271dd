#include "core/odometry/motion_covariance.hpp"

#include <gtest/gtest.h>

#include "core/geometry/so3.hpp"
#include "core/odometry/map_drift.hpp"

namespace slamd::odometry {
namespace {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

Matrix6d some_covariance() {
  Matrix6d A;
  for (int i = 0; i < 36; ++i) {
    A(i / 6, i % 6) = 0.01 * ((7 * i) % 11 - 5);
  }
  return A * A.transpose() + 1e-4 * Matrix6d::Identity();
}

/// What the errors that all points share, at both ends, add to the covariance of a motion.
Matrix6d shared_over(const Se3& T_odom_first, const Se3& T_odom_last) {
  MotionStep first;
  first.T_odom_base = T_odom_first;
  MotionStep last;
  last.T_odom_base = T_odom_last;
  MotionCovariance nothing_else(first);
  nothing_else.add(last);
  return nothing_else.covariance();
}

MotionStep step_at(const Se3& T_odom_base, const Matrix6d& P) {
  MotionStep step;
  step.T_odom_base = T_odom_base;
  step.P_filter_base.topRows<6>() = P;
  return step;
}

TEST(MotionCovariance, AddsBothEndsWhereTheScansForgetEarlierErrors) {
  const Matrix6d P = 1e-4 * Matrix6d::Identity();
  MotionStep last = step_at(Se3(Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.0}), P);
  last.transition.setZero();

  MotionCovariance sut(step_at(Se3{}, P));
  sut.add(last);

  EXPECT_TRUE(sut.covariance().isApprox(2.0 * (P + errors_of_all_points()), 1e-12));
}

TEST(MotionCovariance, LeavesOutWhatBothEndsHaveInCommon) {
  // Nothing is ever measured: the second pose has all of the first one's error, and some more.
  const Matrix6d P = some_covariance();
  const Matrix6d more = 1e-3 * Matrix6d::Identity();
  const Se3 T(geometry::rotation_from_rpy({0.1, -0.2, 0.7}), {3.0, 1.0, 0.5});

  MotionCovariance sut(step_at(T, P));
  sut.add(step_at(T, P + more));

  EXPECT_TRUE((sut.covariance() - shared_over(T, T)).isApprox(more, 1e-9)) << sut.covariance();
}

TEST(MotionCovariance, IsThatOfTheMotionsPerturbation) {
  // Errors of the first pose alone, against the derivative by differences.
  const Matrix6d P = some_covariance();
  const Se3 T_odom_first(geometry::rotation_from_rpy({0.1, -0.2, 0.7}), {3.0, 1.0, 0.5});
  const Se3 T_odom_last(geometry::rotation_from_rpy({-0.3, 0.1, 1.9}), {8.0, 4.0, -0.5});
  MotionStep last = step_at(T_odom_last, Matrix6d::Zero());
  last.transition.setZero();
  const Se3 T_first_last = T_odom_first.inverse() * T_odom_last;
  Matrix6d J;
  for (int i = 0; i < 6; ++i) {
    const Se3 other = geometry::boxplus(T_odom_first, 1e-6 * Vector6d::Unit(i)).inverse() * T_odom_last;
    J.col(i) = 1e6 * geometry::boxminus(other, T_first_last);
  }

  MotionCovariance sut(step_at(T_odom_first, P));
  sut.add(last);

  EXPECT_TRUE((sut.covariance() - shared_over(T_odom_first, T_odom_last)).isApprox(J * P * J.transpose(), 1e-4));
}

TEST(MotionCovariance, TurnsThatTheMapDriftedMoveWhatComesAfter) {
  MotionStep drifted = step_at(Se3(Eigen::Matrix3d::Identity(), {1.0, 0.0, 0.0}), Matrix6d::Zero());
  drifted.drift_base(5, 5) = 1e-6;  // 1 mrad of heading
  const MotionStep last = step_at(Se3(Eigen::Matrix3d::Identity(), {11.0, 0.0, 0.0}), Matrix6d::Zero());

  MotionCovariance sut(step_at(Se3{}, Matrix6d::Zero()));
  sut.add(drifted);
  sut.add(last);

  const Matrix6d found = sut.covariance() - shared_over(Se3{}, last.T_odom_base);
  EXPECT_NEAR(found(1, 1), 1e-4, 1e-9);  // 10 mm after 10 m
  EXPECT_NEAR(found(5, 5), 1e-6, 1e-12);
  EXPECT_NEAR(found(0, 0), 0.0, 1e-12);
}

TEST(MotionCovariance, LetsABlindWayGrowWithTheWayAndUndoItselfOnTheWayBack) {
  const Eigen::Matrix3d R = geometry::rotation_from_rpy({0.0, 0.0, M_PI / 2});
  MotionCovariance sut(step_at(Se3(R, Eigen::Vector3d::Zero()), Matrix6d::Zero()));
  const auto drive = [&](double step_m) {
    MotionStep step = step_at(Se3(R, Eigen::Vector3d::Zero()), Matrix6d::Zero());
    step.blind_odom = {0.0, 0.01 * step_m, 0.0};
    for (int i = 0; i < 10; ++i) {
      sut.add(step);
    }
  };

  drive(1.0);
  EXPECT_NEAR(sut.covariance()(0, 0), 0.1 * 0.1, 1e-6);  // odom's y is ahead
  drive(-1.0);

  EXPECT_NEAR(sut.covariance()(0, 0), 0.0, 1e-6);
}

}  // namespace
}  // namespace slamd::odometry
