#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/live_drive.hpp"

namespace slamd::simulate {
namespace {

constexpr double kStep_s = Motion::kKnot_s;

/// A hall of 40 m × 40 m with a wall across it at x = 25 m.
struct Hall {
  World world;
  Route route;

  Hall() : world([](double, double) { return 0.0; }, {40.0, 40.0}, 1) {
    world.add(OrientedBox{{25.1, 20.0, 1.5}, {0.1, 20.0, 1.5}});
    world.build();
    route.floor = [](double, double) { return 0.0; };
  }

  DrivenVehicle vehicle(const Place& start = {{10.0, 20.0}, 0.0}) const { return {world, route, Ride{}, start, 1}; }
};

void advance(DrivenVehicle& sut, const Velocity& command, double seconds) {
  for (int k = 0; k < std::lround(seconds / kStep_s); ++k) {
    sut.advance(command, 0.0);
  }
}

TEST(DrivenVehicle, AcceleratesAndBrakesWithinItsLimits) {
  const Hall hall;
  DrivenVehicle sut = hall.vehicle();

  advance(sut, {1.0, 0.0}, 1.0);
  EXPECT_NEAR(sut.velocity().v_mps, 0.8, 1e-9);
  EXPECT_NEAR(sut.place().position_m.x(), 10.4, 0.01);
  advance(sut, {1.0, 0.0}, 1.0);
  EXPECT_NEAR(sut.velocity().v_mps, 1.0, 1e-9);
  advance(sut, {0.0, 0.0}, 0.5);
  EXPECT_NEAR(sut.velocity().v_mps, 0.25, 1e-9);
  advance(sut, {0.0, 0.0}, 0.5);
  EXPECT_EQ(sut.velocity().v_mps, 0.0);
}

TEST(DrivenVehicle, TurnsOnTheSpotToTheLeft) {
  const Hall hall;
  DrivenVehicle sut = hall.vehicle();

  advance(sut, {0.0, 1.0}, 2.0);
  advance(sut, {0.0, 0.0}, 1.0);

  EXPECT_NEAR(sut.place().yaw_rad, 2.0, 0.01);
  EXPECT_EQ(sut.place().position_m, Eigen::Vector2d(10.0, 20.0));
}

TEST(DrivenVehicle, DrivesACircleOfTheRadiusThatTheCommandSays) {
  const Hall hall;
  DrivenVehicle sut = hall.vehicle();
  advance(sut, {1.0, 0.5}, 3.0);
  const Place begin = sut.place();

  advance(sut, {1.0, 0.5}, 2.0 * M_PI);  // half a circle

  EXPECT_NEAR((sut.place().position_m - begin.position_m).norm(), 4.0, 0.05);
}

TEST(DrivenVehicle, DoesNoMoreThanItCan) {
  const Hall hall;
  DrivenVehicle sut = hall.vehicle();

  advance(sut, {1e9, -1e9}, 4.0);

  EXPECT_EQ(sut.velocity().v_mps, sut.limits().speed_mps);
  EXPECT_EQ(sut.velocity().w_radps, -sut.limits().turn_rate_radps);
}

TEST(DrivenVehicle, StopsAtAWallAndCountsItOnceUntilItHasLeft) {
  const Hall hall;
  DrivenVehicle sut = hall.vehicle({{22.0, 20.0}, 0.0});

  advance(sut, {1.5, 0.0}, 10.0);

  EXPECT_EQ(sut.collisions(), 1U);
  EXPECT_EQ(sut.velocity().v_mps, 0.0);
  EXPECT_LT(sut.place().position_m.x() + 0.5 * sut.limits().length_m, 25.0);
  EXPECT_GT(sut.place().position_m.x() + 0.5 * sut.limits().length_m, 24.95);

  advance(sut, {-0.5, 0.0}, 2.0);
  EXPECT_LT(sut.place().position_m.x(), 24.0);
  advance(sut, {1.5, 0.0}, 3.0);
  EXPECT_EQ(sut.collisions(), 2U);
}

TEST(DrivenVehicle, MeetsAPoleWithItsCorner) {
  Hall hall;
  hall.world.add(Cylinder{{12.0, 20.3}, 0.04, 0.0, 5.0});
  hall.world.build();
  DrivenVehicle sut = hall.vehicle();

  advance(sut, {1.5, 0.0}, 5.0);

  EXPECT_EQ(sut.collisions(), 1U);
  EXPECT_LT(sut.place().position_m.x(), 11.6);
}

TEST(DrivenVehicle, StopsAtTheEndOfTheWorld) {
  const Hall hall;
  DrivenVehicle sut = hall.vehicle({{2.0, 20.0}, M_PI});

  advance(sut, {1.5, 0.0}, 5.0);

  EXPECT_EQ(sut.collisions(), 1U);
  EXPECT_GE(sut.place().position_m.x(), 0.4);
}

TEST(Motion, IsNotChangedInThePastByWhatIsAppended) {
  const Motion::Channels there{1.0, 2.0, 0.5, 0.1, 0.0, 0.0};
  Motion sut = standing(there, Ride{.vibration_mps2 = 0.3}, 1);
  for (int k = 0; k < 20; ++k) {
    sut.append({1.0 + 0.01 * k * k, 2.0, 0.5, 0.1 + 0.02 * k, 0.0, 0.0}, 0.5);
  }
  const geometry::Se3 before = sut.pose_at(0.97);

  sut.append({100.0, 0.0, 0.0, 3.0, 0.0, 0.0}, 1.0);

  EXPECT_NEAR(sut.duration_s(), 21 * kStep_s, 1e-12);
  EXPECT_EQ(sut.pose_at(0.97).translation(), before.translation());
}

/// What a drive of straight line and bend gives, moment by moment.
class DrivenSensors : public testing::TestWithParam<LidarKind> {
 protected:
  DrivenSensors() {
    drive_.world = "warehouse";
    drive_.lidar = GetParam();
    drive_.vehicle = VehicleKind::kSkidSteer;
    drive_.driven = true;
    live_.emplace(drive_);
    for (int k = 0; k < 40; ++k) {
      const Moment moment = live_->next({1.0, k < 20 ? 0.0 : 0.5});
      packets_.insert(packets_.end(), moment.packets.begin(), moment.packets.end());
      rows_.insert(rows_.end(), moment.rows.begin(), moment.rows.end());
      truths_.insert(truths_.end(), moment.truths.begin(), moment.truths.end());
    }
  }

  Drive drive_;
  std::optional<LiveDrive> live_;
  std::vector<SentPacket> packets_;
  std::vector<Moment::Row> rows_;
  std::vector<Moment::Truth> truths_;
};

TEST_P(DrivenSensors, GiveEveryPacketInTheOrderOfSendingAsTheWholeMotionHasIt) {
  PacketStream whole(live_->scene());
  double last_s = 0.0;

  for (const SentPacket& sut : packets_) {
    const SentPacket* expected = nullptr;
    ASSERT_TRUE(whole.next(expected));
    ASSERT_EQ(sut.sent_s, expected->sent_s);
    ASSERT_TRUE(sut.payload == expected->payload);
    ASSERT_GE(sut.sent_s, last_s);
    last_s = sut.sent_s;
  }
  EXPECT_GT(last_s, 2.0 - 0.01);
}

TEST_P(DrivenSensors, GiveEveryInertialSampleAndTruthAsTheWholeMotionHasThem) {
  InertialSensor whole = live_->scene().imu();
  for (const Moment::Row& sut : rows_) {
    double t_s = 0.0;
    InertialReading expected;
    ASSERT_TRUE(whole.next(t_s, expected));
    ASSERT_EQ(sut.t_s, t_s);
    ASSERT_EQ(sut.reading.rate_radps, expected.rate_radps);
    ASSERT_EQ(sut.reading.force_mps2, expected.force_mps2);
  }
  EXPECT_EQ(rows_.size(), 400U);
  EXPECT_EQ(truths_.size(), 200U);
  EXPECT_EQ(truths_.back().motion.T_world_base.translation(),
            live_->scene().motion().pose_at(truths_.back().t_s).translation());
}

INSTANTIATE_TEST_SUITE_P(Lidars, DrivenSensors,
                         testing::Values(LidarKind::kVlp16, LidarKind::kLivoxAvia, LidarKind::kLivoxMid360),
                         [](const auto& lidar) { return name_of(lidar.param); });

}  // namespace
}  // namespace slamd::simulate
