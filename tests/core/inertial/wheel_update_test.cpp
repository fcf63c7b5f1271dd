#include "core/inertial/wheel_update.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/inertial/propagation.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::inertial {
namespace {

using geometry::Se3;
using sensor::WheelSample;

constexpr double kSpeed_mps = 1.5;

/// A vehicle that drives straight ahead without any inertial sensor, known to have `speed_std_mps`.
struct Fixture {
  NavState state;
  Covariance P = Covariance::Identity() * 1e-6;
  WheelUpdate sut{WheelConfig{}};

  explicit Fixture(double speed_std_mps) {
    state.v_odom_imu.x() = kSpeed_mps;
    P.diagonal().segment<3>(kVelocity).setConstant(speed_std_mps * speed_std_mps);
  }

  bool add(double speed_mps) {
    return sut.update({state.stamp, speed_mps, 0.0}, Se3{}, Eigen::Vector3d::Zero(), true, state, P);
  }
};

TEST(WheelUpdate, TakesTheSpeedWhereTheStateDoesNotKnowIt) {
  Fixture fixture(1.0);

  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(fixture.add(1.0));
  }

  EXPECT_NEAR(fixture.state.v_odom_imu.x(), 1.0, 0.05);
  EXPECT_LT(fixture.P(kVelocity, kVelocity), 0.05 * 0.05);
}

TEST(WheelUpdate, LearnsTheScaleWhereTheStateKnowsTheSpeed) {
  Fixture fixture(0.001);

  for (int i = 0; i < 200; ++i) {
    fixture.add(kSpeed_mps / 1.02);
  }

  EXPECT_NEAR(fixture.sut.scale(), 1.02, 0.003);
  EXPECT_LT(fixture.sut.scale_std(), 0.005);
  EXPECT_NEAR(fixture.state.v_odom_imu.x(), kSpeed_mps, 0.005);
}

TEST(WheelUpdate, LeavesOutWheelsThatSlip) {
  Fixture fixture(0.02);

  EXPECT_FALSE(fixture.add(1.5 * kSpeed_mps));
  EXPECT_TRUE(fixture.add(kSpeed_mps));

  EXPECT_EQ(fixture.sut.counts().slipped, 1U);
  EXPECT_EQ(fixture.sut.counts().used, 1U);
  EXPECT_NEAR(fixture.state.v_odom_imu.x(), kSpeed_mps, 1e-6);
}

TEST(WheelUpdate, HoldsTheVehicleFromDriftingSideways) {
  Fixture fixture(0.5);
  fixture.state.v_odom_imu.y() = 0.4;

  for (int i = 0; i < 50; ++i) {
    fixture.add(kSpeed_mps);
  }

  EXPECT_NEAR(fixture.state.v_odom_imu.y(), 0.0, 0.02);
}

TEST(WheelUpdate, CarriesWhatTheLidarSaysOfTheWayOverToTheScale) {
  // Ten seconds ahead by wheels that are 2 % too large, a look at the true place each second.
  Fixture fixture(0.5);
  for (int second = 0; second < 10; ++second) {
    for (int i = 0; i < 50; ++i) {
      propagate_constant_velocity(fixture.state, fixture.P, fixture.state.stamp + std::chrono::milliseconds(20), {0.1, 0.1},
                                  &fixture.sut.followers());
      fixture.add(kSpeed_mps / 1.02);
    }
    NavState posterior = fixture.state;
    Covariance P = fixture.P;
    const ErrorState h = ErrorState::Unit(kPosition);
    const double S = P(kPosition, kPosition) + 1e-4;
    const ErrorState gain = P * h / S;
    posterior = boxplus(posterior, ErrorState(gain * (kSpeed_mps * (second + 1) - posterior.T_odom_imu.translation().x())));
    P -= S * gain * gain.transpose();
    fixture.sut.follow(fixture.state, fixture.P, posterior, P);
    fixture.state = posterior;
    fixture.P = P;
  }

  EXPECT_NEAR(fixture.sut.scale(), 1.02, 0.004);
}

TEST(WheelUpdate, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Fixture fixture(0.1);

  EXPECT_EQ(support::count_allocations([&] { fixture.add(kSpeed_mps); }), 0U);
}

TEST(WheelUpdate, HandsOnItsErrorsByATransitionThatLeavesOnlyWhatNoiseAdds) {
  Fixture fixture(0.3);
  const auto whole = [&] {
    Transition P;
    const ErrorState cross = fixture.sut.cross();
    P << fixture.P, cross, cross.transpose(), fixture.sut.scale_variance();
    return P;
  };
  for (int i = 0; i < 5; ++i) {
    fixture.add(kSpeed_mps);
  }
  const Transition before = whole();
  fixture.sut.begin_transition();

  for (int i = 0; i < 10; ++i) {
    propagate_constant_velocity(fixture.state, fixture.P, fixture.state.stamp + std::chrono::milliseconds(20), {0.1, 0.1},
                                &fixture.sut.followers());
    fixture.add(kSpeed_mps);
  }
  const Covariance P_prior = fixture.P;
  fixture.P = (P_prior.inverse() + 1e4 * Covariance::Identity()).inverse();
  fixture.sut.follow(fixture.state, P_prior, fixture.state, fixture.P);

  const Transition T = fixture.sut.transition();
  const Transition noise = whole() - T * before * T.transpose();
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Transition>(noise).eigenvalues().minCoeff(), -1e-12);
  EXPECT_LT(noise.trace(), whole().trace());
  EXPECT_GT(T(kErrorStates, kErrorStates), 0.1);  // the scale's own error lives on
}

}  // namespace
}  // namespace slamd::inertial
