#include "core/inertial/zero_velocity.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/inertial/start_up_alignment.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::inertial {
namespace {

using sensor::ImuSample;
using sensor::WheelSample;

constexpr Duration kImuPeriod = std::chrono::milliseconds(5);

/// A vehicle whose start was levelled, and then nobody but its inertial sensor tells of; a tenth of a second a step.
struct Unwatched {
  std::mt19937_64 engine{7};
  std::normal_distribution<double> normal;
  ImuNoise noise;
  NavState state;
  Covariance P = Covariance::Identity();
  ImuSample last;
  ZeroVelocityUpdate sut{ZeroVelocityConfig{}};
  int held = 0;

  Unwatched() {
    StartUpAlignment aligner{StartUpConfig{}};
    std::optional<Alignment> alignment;
    while (!alignment) {
      alignment = aligner.add(next(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()), geometry::Se3{});
    }
    state = alignment->state;
    P = alignment->P;
  }

  ImuSample next(const Eigen::Vector3d& rate_radps, const Eigen::Vector3d& acceleration_mps2) {
    last.stamp += kImuPeriod;
    const Eigen::Vector3d force = acceleration_mps2 + Eigen::Vector3d(0.07, -0.05, kGravityMps2 + 0.03);
    for (int axis = 0; axis < 3; ++axis) {
      last.angular_rate_radps[axis] = rate_radps[axis] + 0.003 + 0.003 * normal(engine);
      last.specific_force_mps2[axis] = force[axis] + 0.025 * normal(engine);
    }
    return last;
  }

  bool step(const Eigen::Vector3d& rate_radps = Eigen::Vector3d::Zero(),
            const Eigen::Vector3d& acceleration_mps2 = Eigen::Vector3d::Zero(), std::span<const WheelSample> wheels = {}) {
    std::vector<ImuSample> samples{last};
    for (int i = 0; i < 20; ++i) {
      samples.push_back(next(rate_radps, acceleration_mps2));
    }
    propagate(state, P, samples, last.stamp, noise);
    const bool holds = sut.update(samples, wheels, noise, state, P);
    held += holds ? 1 : 0;
    return holds;
  }
};

TEST(ZeroVelocityUpdate, HoldsAVehicleThatStandsForMinutes) {
  Unwatched fixture;

  for (int i = 0; i < 1800; ++i) {
    fixture.step();
  }

  EXPECT_GT(fixture.held, 1750);
  EXPECT_LT(fixture.state.T_odom_imu.translation().norm(), 0.05);
  EXPECT_LT(geometry::boxminus(fixture.state.T_odom_imu, geometry::Se3{}).tail<3>().norm(), 0.01);
  EXPECT_LT(std::sqrt(fixture.P.diagonal().head<3>().maxCoeff()), 0.2);
}

TEST(ZeroVelocityUpdate, LeavesAnEvenDriveAlone) {
  Unwatched fixture;
  fixture.state.v_odom_imu = {0.5, 0.0, 0.0};

  for (int i = 0; i < 50; ++i) {
    fixture.step();
  }

  EXPECT_EQ(fixture.held, 0);
  EXPECT_NEAR(fixture.state.T_odom_imu.translation().x(), 2.5, 0.5);
}

TEST(ZeroVelocityUpdate, LeavesACreepAlone) {
  for (const double speed_mps : {0.05, 0.1, 0.2}) {
    Unwatched fixture;
    fixture.state.v_odom_imu = {speed_mps, 0.0, 0.0};

    for (int i = 0; i < 50; ++i) {
      fixture.step();
    }

    EXPECT_EQ(fixture.held, 0) << speed_mps;
  }
}

TEST(ZeroVelocityUpdate, LetsGoWhenTheVehicleStartsHoweverGently) {
  for (const double acceleration_mps2 : {0.2, 0.5, 2.0}) {
    Unwatched fixture;
    for (int i = 0; i < 100; ++i) {
      fixture.step();
    }
    for (int i = 0; i < 20; ++i) {
      fixture.step(Eigen::Vector3d::Zero(), {acceleration_mps2, 0.0, 0.0});
    }

    EXPECT_NEAR(fixture.state.v_odom_imu.x(), 2.0 * acceleration_mps2, 0.12) << acceleration_mps2;
  }
}

TEST(ZeroVelocityUpdate, LetsGoWhenItTurns) {
  Unwatched fixture;
  for (int i = 0; i < 100; ++i) {
    fixture.step();
  }

  for (int i = 0; i < 20; ++i) {
    fixture.step({0.0, 0.0, 0.1});
  }

  EXPECT_NEAR(geometry::boxminus(fixture.state.T_odom_imu, geometry::Se3{})[5], 0.2, 0.02);
}

TEST(ZeroVelocityUpdate, BelievesWheelsThatTurn) {
  Unwatched fixture;
  const std::vector<WheelSample> standing{{fixture.last.stamp, 0.0, 0.0}};
  const std::vector<WheelSample> turning{{fixture.last.stamp, 0.05, 0.0}};

  EXPECT_TRUE(fixture.step(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), standing));
  EXPECT_FALSE(fixture.step(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), turning));
}

TEST(ZeroVelocityUpdate, TrustsWheelsThatStandWhereTheInertialSensorIsSilent) {
  Unwatched fixture;
  fixture.state.gyro_bias = {0.0, 0.0, -0.01};  // it turns
  fixture.P.diagonal().segment<3>(kGyroBias).setConstant(0.01);
  fixture.P.diagonal().segment<3>(kVelocity).setConstant(0.1);
  const std::vector<WheelSample> standing{{fixture.last.stamp, 0.0, 0.0}};

  const bool holds = fixture.sut.update({}, standing, fixture.noise, fixture.state, fixture.P);
  const bool without_any = fixture.sut.update({}, {}, fixture.noise, fixture.state, fixture.P);

  EXPECT_TRUE(holds);
  EXPECT_FALSE(without_any);
  EXPECT_NEAR(fixture.state.gyro_bias.z(), 0.0, 0.001);
}

TEST(ZeroVelocityUpdate, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Unwatched fixture;
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20; ++i) {
    samples.push_back(fixture.next(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()));
  }

  const auto allocations = support::count_allocations(
      [&] { fixture.held += fixture.sut.update(samples, {}, fixture.noise, fixture.state, fixture.P) ? 1 : 0; });

  EXPECT_EQ(fixture.held, 1);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::inertial
