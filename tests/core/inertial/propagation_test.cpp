#include "core/inertial/propagation.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/geometry/so3.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::inertial {
namespace {

using sensor::ImuSample;

NavState some_state() {
  NavState state;
  state.T_odom_imu = geometry::Se3(geometry::so3_exp({0.3, -0.2, 1.1}), Eigen::Vector3d(1.0, 2.0, 3.0));
  state.v_odom_imu = {1.5, -0.4, 0.1};
  state.gyro_bias = {0.01, -0.02, 0.005};
  state.accel_bias = {0.1, 0.05, -0.2};
  state.g_odom = geometry::so3_exp({0.02, -0.01, 0.0}) * state.g_odom;
  return state;
}

const ImuNoise kNoiseless{0.0, 0.0, 0.0, 0.0};

TEST(Propagation, CovarianceFollowsTheNumericJacobian) {
  const NavState state = some_state();
  const ImuSample sample{Stamp{}, {0.4, -0.3, 0.8}, {0.5, 1.0, 9.5}};
  constexpr double kDt_s = 0.005;
  constexpr double kStep = 1e-6;
  Covariance numeric;
  NavState moved = state;
  propagate_mean(moved, sample, kDt_s);
  for (int i = 0; i < kErrorStates; ++i) {
    NavState plus = boxplus(state, kStep * ErrorState::Unit(i));
    NavState minus = boxplus(state, -kStep * ErrorState::Unit(i));
    propagate_mean(plus, sample, kDt_s);
    propagate_mean(minus, sample, kDt_s);
    numeric.col(i) = (boxminus(plus, moved) - boxminus(minus, moved)) / (2.0 * kStep);
  }

  NavState sut = state;
  Covariance P = Covariance::Identity();
  propagate_interval(sut, P, sample, kDt_s, kNoiseless);

  // First-order F against the exact derivative: terms of dt² that the filter drops stay below 1e-4.
  EXPECT_LT((P - numeric * numeric.transpose()).cwiseAbs().maxCoeff(), 2e-4);
  EXPECT_LT(boxminus(sut, moved).norm(), 1e-12);
}

TEST(Propagation, RestStaysAtRest) {
  NavState sut;
  Covariance P = Covariance::Identity() * 1e-6;
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 400; ++i) {
    samples.push_back({Stamp{} + i * std::chrono::milliseconds(5), Eigen::Vector3d::Zero(), {0.0, 0.0, kGravityMps2}});
  }

  propagate(sut, P, samples, Stamp{} + std::chrono::seconds(2), ImuNoise{});

  EXPECT_LT(sut.T_odom_imu.translation().norm(), 1e-9);
  EXPECT_LT(sut.v_odom_imu.norm(), 1e-9);
  EXPECT_EQ(sut.stamp, Stamp{} + std::chrono::seconds(2));
}

TEST(Propagation, CircularMotionComesBack) {
  // 2 m/s on a circle of radius 2 m: turn rate 1 rad/s, centripetal 2 m/s² to the left.
  NavState sut;
  sut.v_odom_imu = {2.0, 0.0, 0.0};
  Covariance P = Covariance::Identity() * 1e-6;
  std::vector<ImuSample> samples;
  const Duration turn = from_seconds(2.0 * M_PI);
  for (Stamp now{}; now <= Stamp{} + turn + std::chrono::milliseconds(5); now += std::chrono::milliseconds(5)) {
    samples.push_back({now, {0.0, 0.0, 1.0}, {0.0, 2.0, kGravityMps2}});
  }

  propagate(sut, P, samples, Stamp{} + turn, ImuNoise{});

  EXPECT_LT(sut.T_odom_imu.translation().norm(), 1e-4);
  EXPECT_LT((sut.v_odom_imu - Eigen::Vector3d(2.0, 0.0, 0.0)).norm(), 1e-4);
}

TEST(Propagation, ConstantVelocityTurnsAgainstTheGyroBias) {
  NavState sut;
  sut.v_odom_imu = {1.0, 0.0, 0.0};
  sut.gyro_bias = {0.0, 0.0, -0.5};
  Covariance P = Covariance::Identity() * 1e-4;
  const double before = P(kRotation + 2, kRotation + 2);

  propagate_constant_velocity(sut, P, Stamp{} + std::chrono::seconds(1), ConstantVelocityNoise{});

  EXPECT_NEAR(geometry::rpy_from_rotation(sut.T_odom_imu.rotation()).z(), 0.5, 1e-12);
  EXPECT_NEAR(sut.T_odom_imu.translation().x(), 1.0, 1e-12);
  EXPECT_GT(P(kRotation + 2, kRotation + 2), before);
  EXPECT_LT(P(kRotation + 2, kGyroBias + 2), 0.0);  // turned too far: ω too large, so −ω too small
}

TEST(Propagation, StaysWhereItIsWhenNobodyTellsOfTheTimeAndSaysWhatThatIsWorth) {
  NavState sut = some_state();
  Covariance P = Covariance::Identity() * 1e-4;
  P(kPosition, kVelocity) = P(kVelocity, kPosition) = 5e-5;
  const NavState before = sut;

  propagate_unseen(sut, P, before.stamp + std::chrono::seconds(60), UnseenMotion{});

  EXPECT_EQ(sut.T_odom_imu.translation(), before.T_odom_imu.translation());
  EXPECT_EQ(sut.stamp, before.stamp + std::chrono::seconds(60));
  EXPECT_EQ(sut.v_odom_imu.norm(), 0.0);
  EXPECT_EQ(sut.gyro_bias, before.gyro_bias);
  EXPECT_NEAR(std::sqrt(P(kPosition, kPosition)), 60.0, 0.1);
  EXPECT_EQ(P(kPosition, kVelocity), 0.0);
  // A vehicle turns about the vertical, whatever way the sensor is mounted.
  const Eigen::Vector3d up_imu = -(before.T_odom_imu.rotation().transpose() * before.g_odom).normalized();
  EXPECT_NEAR(std::sqrt(up_imu.dot(P.block<3, 3>(kRotation, kRotation) * up_imu)), 3.0, 0.1);
  EXPECT_LT(std::sqrt(up_imu.unitOrthogonal().dot(P.block<3, 3>(kRotation, kRotation) * up_imu.unitOrthogonal())), 0.1);
}

TEST(Propagation, ATurnLeavesTheSensorsScaleTimesItselfHoweverManyStepsItTakes) {
  for (const int steps : {1, 7, 40}) {
    const ImuNoise noise{0.0, 0.0, 0.0, 0.0};
    NavState sut;
    Covariance P = Covariance::Zero();
    const ImuSample turning{Stamp{}, {0.0, 0.0, 1.4}, {0.0, 0.0, 9.8}};
    for (int i = 0; i < steps; ++i) {
      const Duration t0 = std::chrono::seconds(2) * i / steps;
      const Duration t1 = std::chrono::seconds(2) * (i + 1) / steps;
      propagate_interval(sut, P, turning, to_seconds(t1 - t0), noise.between(t0, t1));
    }

    EXPECT_NEAR(std::sqrt(P(kRotation + 2, kRotation + 2)), noise.gyro_scale_error * 2.8, 1e-6);
  }
}

TEST(Propagation, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  NavState sut = some_state();
  Covariance P = Covariance::Identity();
  const std::vector<ImuSample> samples{{Stamp{}, {0.1, 0.2, 0.3}, {0.0, 0.0, 9.8}},
                                       {Stamp{} + std::chrono::milliseconds(50), {0.1, 0.2, 0.3}, {0.0, 0.0, 9.8}}};

  const std::size_t allocations = support::count_allocations(
      [&] { propagate(sut, P, samples, Stamp{} + std::chrono::milliseconds(40), ImuNoise{}); });

  EXPECT_EQ(allocations, 0U);
}

TEST(NavState, BoxminusInvertsBoxplus) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> uniform(-0.05, 0.05);
  const NavState state = some_state();
  for (int i = 0; i < 100; ++i) {
    ErrorState delta;
    for (double& value : delta) {
      value = uniform(engine);
    }

    EXPECT_LT((boxminus(boxplus(state, delta), state) - delta).norm(), 2e-4);
  }
}

}  // namespace
}  // namespace slamd::inertial
