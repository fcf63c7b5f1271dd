#include <gtest/gtest.h>

#include <cmath>

#include "core/base/units.hpp"
#include "core/geometry/so3.hpp"
#include "tools/simulate/scenery.hpp"

namespace slamd::simulate {
namespace {


Motion ridden(VehicleKind vehicle, double vibration_mps2 = 0.0, double bumps = 0.0,
              const std::string& world = "warehouse") {
  Ride ride;
  ride.vehicle = vehicle;
  ride.duration_s = 240.0;
  ride.vibration_mps2 = vibration_mps2;
  ride.bumps_per_100m = bumps;
  return drive(make_scenery(world, 1, {})->route(), ride, 1);
}

double fastest_turn_degps(const Motion& motion) {
  double fastest = 0.0;
  for (double t = 0.0; t < motion.duration_s(); t += 0.02) {
    fastest = std::max(fastest, motion.at(t).rate_base_radps.norm() / kDegree);
  }
  return fastest;
}

TEST(SkidSteer, TurnsOnTheSpotAtUpToTheGivenRate) {
  const Motion sut = ridden(VehicleKind::kSkidSteer);

  EXPECT_GT(fastest_turn_degps(sut), 70.0);
  EXPECT_LT(fastest_turn_degps(sut), 135.0);
  int on_the_spot = 0;
  for (double t = 0.0; t < sut.duration_s(); t += 0.02) {
    const MotionState state = sut.at(t);
    on_the_spot += std::abs(state.rate_base_radps.z()) > 60.0 * kDegree && state.velocity_mps.norm() < 0.05 ? 1 : 0;
  }
  EXPECT_GT(on_the_spot, 20);
}

TEST(Ackermann, NeverTurnsWithoutMoving) {
  const Motion sut = ridden(VehicleKind::kAckermann);

  for (double t = 0.0; t < sut.duration_s(); t += 0.02) {
    const MotionState state = sut.at(t);
    if (std::abs(state.rate_base_radps.z()) > 20.0 * kDegree) {
      EXPECT_GT(state.velocity_mps.norm(), 0.15) << "at " << t << " s";
    }
  }
  EXPECT_LT(fastest_turn_degps(sut), 90.0);
}

TEST(Handheld, SwingsAsSomebodyInAHurryDoes) {
  const Motion sut = ridden(VehicleKind::kHandheld);

  EXPECT_GT(fastest_turn_degps(sut), 90.0);
  double steepest = 0.0;
  for (double t = 10.0; t < 60.0; t += 0.05) {
    steepest = std::max(steepest, std::acos(sut.pose_at(t).rotation()(2, 2)) / kDegree);
  }
  EXPECT_GT(steepest, 8.0);
}

TEST(EveryVehicle, HasDerivativesThatAgreeWithItsPoses) {
  for (const VehicleKind vehicle : {VehicleKind::kAckermann, VehicleKind::kSkidSteer, VehicleKind::kHandheld}) {
    const Motion sut = ridden(vehicle, 0.3, 2.0);
    constexpr double kStep_s = 1e-4;
    for (double t = 1.0; t < 200.0; t += 1.37) {
      const geometry::Se3 before = sut.pose_at(t - kStep_s);
      const geometry::Se3 now = sut.pose_at(t);
      const geometry::Se3 after = sut.pose_at(t + kStep_s);
      const MotionState state = sut.at(t);

      const Eigen::Vector3d velocity = (after.translation() - before.translation()) / (2.0 * kStep_s);
      const Eigen::Vector3d acceleration =
          (after.translation() - 2.0 * now.translation() + before.translation()) / (kStep_s * kStep_s);
      const Eigen::Vector3d rate =
          geometry::so3_log(before.rotation().transpose() * after.rotation()) / (2.0 * kStep_s);

      EXPECT_LT((velocity - state.velocity_mps).norm(), 1e-5);
      EXPECT_LT((acceleration - state.acceleration_mps2).norm(), 1e-3);
      EXPECT_LT((rate - state.rate_base_radps).norm(), 1e-5);
    }
  }
}

TEST(EveryVehicle, HasContinuousAcceleration) {
  for (const VehicleKind vehicle : {VehicleKind::kAckermann, VehicleKind::kSkidSteer, VehicleKind::kHandheld}) {
    const Motion sut = ridden(vehicle);
    const auto largest_step = [&](double step_s) {
      double largest = 0.0;
      for (double t = 0.0; t < 60.0; t += step_s) {
        largest = std::max(largest, (sut.at(t + step_s).acceleration_mps2 - sut.at(t).acceleration_mps2).norm());
      }
      return largest;
    };

    // A jump would not get smaller with the step.
    EXPECT_NEAR(largest_step(1e-4) / largest_step(1e-3), 0.1, 0.01);
    EXPECT_LT(largest_step(1e-3), 0.3);
  }
}

TEST(Vibration, HasTheGivenStrengthWhileMovingOnly) {
  const Motion still = ridden(VehicleKind::kAckermann);
  const Motion sut = ridden(VehicleKind::kAckermann, 0.5);
  const auto rms = [&](double from_s, double to_s) {
    double sum = 0.0;
    int count = 0;
    for (double t = from_s; t < to_s; t += 0.0013, ++count) {
      sum += std::pow((sut.at(t).acceleration_mps2 - still.at(t).acceleration_mps2).z(), 2);
    }
    return std::sqrt(sum / count);
  };

  EXPECT_NEAR(rms(20.0, 40.0), 0.5, 0.08);
  EXPECT_LT(rms(0.5, 2.0), 0.02);
}

TEST(Bumps, LiftTheVehicle) {
  const Motion even = ridden(VehicleKind::kAckermann);
  const Motion sut = ridden(VehicleKind::kAckermann, 0.0, 5.0);
  double highest = 0.0;
  for (double t = 0.0; t < 100.0; t += 0.01) {
    highest = std::max(highest, sut.pose_at(t).translation().z() - even.pose_at(t).translation().z());
  }
  EXPECT_GT(highest, 0.025);
  EXPECT_LT(highest, 0.055);
}

TEST(ShortMotion, IsAsGoodAsTheMotionItselfForAFiringSequence) {
  const Motion motion = ridden(VehicleKind::kHandheld, 0.5);
  for (double t = 5.0; t < 100.0; t += 0.97) {
    const ShortMotion sut(motion, t);

    const geometry::Se3 exact = motion.pose_at(t + 55e-6);
    const geometry::Se3 quick = sut.pose_after(55e-6);

    EXPECT_LT((exact.translation() - quick.translation()).norm(), 1e-9);
    EXPECT_LT((exact.rotation() - quick.rotation()).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace slamd::simulate
