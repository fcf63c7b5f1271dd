#include "tools/simulate/inertial_sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.hpp"
#include "core/inertial/propagation.hpp"
#include "tools/simulate/town.hpp"

namespace slamd::simulate {
namespace {

constexpr InertialErrors kPerfect{.gyro_noise_radps_sqrthz = 0.0,
                                  .accel_noise_mps2_sqrthz = 0.0,
                                  .gyro_bias_radps = 0.0,
                                  .accel_bias_mps2 = 0.0,
                                  .gyro_walk_radps2_sqrthz = 0.0,
                                  .accel_walk_mps3_sqrthz = 0.0,
                                  .scale = 0.0,
                                  .misalignment_rad = 0.0,
                                  .gyro_step_radps = 0.0,
                                  .accel_step_mps2 = 0.0};

/// A sensor away from base and turned, so that lever arm and rotation count.
geometry::Se3 mounting() { return {geometry::rotation_from_rpy({0.1, -0.2, 1.5}), {0.3, -0.2, 0.4}}; }

TEST(InertialReadings, LeadBackToTheTruthWhenIntegratedWithoutErrors) {
  constexpr double kRate_hz = 1000.0;
  const Town town(2);
  const Motion motion = town.tour(30.0, 1.6, 1.0, 0.45);
  const geometry::Se3 T_base_imu = mounting();

  const std::vector<InertialReading> sut = readings(motion, T_base_imu, kRate_hz, kPerfect, 1);

  const auto sample = [&](std::size_t i) {
    return sensor::ImuSample{Stamp{} + from_seconds(static_cast<double>(i) / kRate_hz), sut[i].rate_radps, sut[i].force_mps2};
  };
  const MotionState start = motion.at(0.0);
  inertial::NavState state;
  const geometry::Se3 T_world_imu = start.T_world_base * T_base_imu;
  state.stamp = Stamp{};
  state.T_odom_imu = T_world_imu;
  state.v_odom_imu = start.velocity_mps + start.T_world_base.rotation() * start.rate_base_radps.cross(T_base_imu.translation());
  for (std::size_t i = 1; i < sut.size(); ++i) {
    inertial::propagate_mean(state, inertial::mean_of(sample(i - 1), sample(i)), 1.0 / kRate_hz);
  }
  const double end_s = static_cast<double>(sut.size() - 1) / kRate_hz;
  const geometry::Vector6d error =
      geometry::boxminus(state.T_odom_imu * T_base_imu.inverse(), motion.pose_at(end_s));
  EXPECT_GT((motion.pose_at(end_s).translation() - start.T_world_base.translation()).norm(), 10.0);
  EXPECT_LT(error.head<3>().norm(), 0.02);
  EXPECT_LT(error.tail<3>().norm(), 1e-4);
}

TEST(InertialReadings, FeelGravityAndNoTurnAtRest) {
  const Town town(2);
  const Motion motion = town.tour(20.0, 1.6, 3.0, 0.45);

  const InertialReading sut = true_reading(motion, mounting(), 1.0);

  EXPECT_NEAR(sut.force_mps2.norm(), 9.80665, 1e-3);
  EXPECT_LT(sut.rate_radps.norm(), 1e-3);
}

TEST(InertialReadings, AreTheSameForTheSameSeedOnly) {
  const Town town(2);
  const Motion motion = town.tour(10.0, 1.6, 1.0, 0.45);
  const auto sut = readings(motion, mounting(), 200.0, InertialErrors{}, 1);
  const auto same = readings(motion, mounting(), 200.0, InertialErrors{}, 1);
  const auto other = readings(motion, mounting(), 200.0, InertialErrors{}, 2);

  ASSERT_GT(sut.size(), 2000U);
  ASSERT_EQ(sut.size(), same.size());
  for (std::size_t i = 0; i < sut.size(); ++i) {
    ASSERT_EQ(sut[i].force_mps2, same[i].force_mps2);
    ASSERT_EQ(sut[i].rate_radps, same[i].rate_radps);
  }
  EXPECT_NE(sut.front().force_mps2, other.front().force_mps2);
}

TEST(InertialReadings, AreAsNoisyAsTheDensitySays) {
  constexpr double kRate_hz = 200.0;
  InertialErrors errors = kPerfect;
  errors.gyro_noise_radps_sqrthz = 2e-4;
  errors.accel_noise_mps2_sqrthz = 2e-3;
  const Town town(2);
  const Motion motion = town.tour(40.0, 1.6, 1.0, 0.45);
  const auto perfect = readings(motion, mounting(), kRate_hz, kPerfect, 1);

  const auto sut = readings(motion, mounting(), kRate_hz, errors, 1);

  double rate_sq = 0.0;
  double force_sq = 0.0;
  for (std::size_t i = 0; i < sut.size(); ++i) {
    rate_sq += (sut[i].rate_radps - perfect[i].rate_radps).squaredNorm();
    force_sq += (sut[i].force_mps2 - perfect[i].force_mps2).squaredNorm();
  }
  const double count = 3.0 * static_cast<double>(sut.size());
  EXPECT_NEAR(std::sqrt(rate_sq / count), 2e-4 * std::sqrt(kRate_hz), 0.05 * 2e-4 * std::sqrt(kRate_hz));
  EXPECT_NEAR(std::sqrt(force_sq / count), 2e-3 * std::sqrt(kRate_hz), 0.05 * 2e-3 * std::sqrt(kRate_hz));
}

}  // namespace
}  // namespace slamd::simulate
