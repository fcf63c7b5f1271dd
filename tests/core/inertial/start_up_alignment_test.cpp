#include "core/inertial/start_up_alignment.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/so3.hpp"
#include "core/inertial/propagation.hpp"

namespace slamd::inertial {
namespace {

using sensor::ImuSample;

/// What an inertial sensor at rest says: noise, biases and gravity.
ImuSample at_rest(Stamp stamp, const Eigen::Matrix3d& R_odom_imu, std::mt19937_64& engine) {
  std::normal_distribution<double> noise(0.0, 1.0);
  const Eigen::Vector3d gyro_bias(0.004, -0.003, 0.002);
  ImuSample sample{stamp, gyro_bias, R_odom_imu.transpose() * Eigen::Vector3d(0.0, 0.0, kGravityMps2)};
  for (int axis = 0; axis < 3; ++axis) {
    sample.angular_rate_radps[axis] += 0.003 * noise(engine);
    sample.specific_force_mps2[axis] += 0.02 * noise(engine);
  }
  return sample;
}

TEST(StartUpAlignment, LevelsAnyMountingWithinAFewMilliradians) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> angle(-3.0, 3.0);
  for (int run = 0; run < 20; ++run) {
    const Eigen::Matrix3d R_base_imu = geometry::rotation_from_rpy({angle(engine), 0.4 * angle(engine), angle(engine)});
    const Eigen::Matrix3d R_odom_base = geometry::rotation_from_rpy({0.1, -0.2, 0.0});  // on a slope
    StartUpAlignment sut{StartUpConfig{}};
    std::optional<Alignment> result;

    for (Stamp now{}; !result && now < Stamp{} + std::chrono::seconds(5); now += std::chrono::milliseconds(5)) {
      result = sut.add(at_rest(now, R_odom_base * R_base_imu, engine), geometry::Se3(R_base_imu, {0.1, 0.2, 0.3}));
    }

    ASSERT_TRUE(result.has_value());
    EXPECT_TRUE(result->at_rest);
    const Eigen::Matrix3d R_odom_base_found = result->state.T_odom_imu.rotation() * R_base_imu.transpose();
    EXPECT_LT(geometry::angle_between(R_odom_base_found, R_odom_base), 0.003);
    EXPECT_LT((result->state.gyro_bias - Eigen::Vector3d(0.004, -0.003, 0.002)).norm(), 0.001);
    const geometry::Se3 T_odom_base = result->state.T_odom_imu * geometry::Se3(R_base_imu, {0.1, 0.2, 0.3}).inverse();
    EXPECT_LT(T_odom_base.translation().norm(), 1e-9);
  }
}

TEST(StartUpAlignment, KeepsPredictingRestWhateverTheAccelerometerBiasIs) {
  // The covariance must know that bias and gravity go together: along that direction "at rest" is certain.
  std::mt19937_64 engine(2);
  StartUpAlignment sut{StartUpConfig{}};
  std::optional<Alignment> result;
  for (Stamp now{}; !result; now += std::chrono::milliseconds(5)) {
    result = sut.add(at_rest(now, Eigen::Matrix3d::Identity(), engine), geometry::Se3());
  }

  NavState state = result->state;
  Covariance P = result->P;
  const ImuSample mean{state.stamp, state.gyro_bias, state.accel_bias - state.T_odom_imu.rotation().transpose() * state.g_odom};
  for (int i = 0; i < 200; ++i) {
    propagate_interval(state, P, mean, 0.005, ImuNoise{0.0, 0.0, 0.0, 0.0});
  }

  // One second with an unknown bias of 0.15 m/s² alone would give 0.15 m/s.
  EXPECT_LT(std::sqrt(P(kVelocity, kVelocity)), 0.03);
  EXPECT_GT(std::sqrt(P(kAccelBias, kAccelBias)), 0.1);
}

TEST(StartUpAlignment, TakesAMovingStartWhenPatienceEnds) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  StartUpAlignment sut{StartUpConfig{}};
  std::optional<Alignment> result;
  Stamp now{};
  for (; !result && now < Stamp{} + std::chrono::seconds(10); now += std::chrono::milliseconds(5)) {
    ImuSample sample = at_rest(now, Eigen::Matrix3d::Identity(), engine);
    sample.angular_rate_radps.z() += 0.4 * noise(engine);
    result = sut.add(sample, geometry::Se3());
  }

  ASSERT_TRUE(result.has_value());
  EXPECT_FALSE(result->at_rest);
  EXPECT_LT(now - Stamp{}, std::chrono::seconds(5));
  EXPECT_GT(result->tilt_std_rad, 0.05);
}

TEST(StartUpAlignment, DoesNotTakeASteadyAccelerationForASlopeWhenTheWheelsTurn) {
  std::mt19937_64 engine(4);
  StartUpAlignment sut{StartUpConfig{}};
  std::optional<Alignment> result;
  Stamp now{};
  for (; !result && now < Stamp{} + std::chrono::seconds(10); now += std::chrono::milliseconds(5)) {
    ImuSample sample = at_rest(now, Eigen::Matrix3d::Identity(), engine);
    const bool speeds_up = now < Stamp{} + std::chrono::milliseconds(1500);
    sample.specific_force_mps2.x() += speeds_up ? 0.8 : 0.0;
    sut.note_moving();
    result = sut.add(sample, geometry::Se3());
  }

  ASSERT_TRUE(result.has_value());
  EXPECT_FALSE(result->at_rest);
  EXPECT_LT(geometry::angle_between(result->state.T_odom_imu.rotation(), Eigen::Matrix3d::Identity()), 0.003);
}

TEST(StartUpAlignment, TakesTheWheelsSpeedStraightAhead) {
  const Eigen::Matrix3d R_base_imu = geometry::rotation_from_rpy({0.3, -0.2, 2.0});
  const Eigen::Matrix3d R_odom_base = geometry::rotation_from_rpy({0.0, -0.1, 0.0});
  Alignment alignment;
  alignment.at_rest = false;
  alignment.state.T_odom_imu = geometry::Se3(R_odom_base * R_base_imu, Eigen::Vector3d::Zero());

  const Alignment sut = with_wheel_speed(alignment, 1.5, geometry::Se3(R_base_imu, {0.1, 0.0, 0.2}));

  EXPECT_LT((sut.state.v_odom_imu - R_odom_base * Eigen::Vector3d(1.5, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_LT(sut.P(kVelocity, kVelocity), 0.1);
}

}  // namespace
}  // namespace slamd::inertial
