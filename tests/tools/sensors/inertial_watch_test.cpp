#include "tools/sensors/inertial_watch.hpp"

#include <gtest/gtest.h>

#include "made_bytes.hpp"
#include "tools/sensors/gravity.hpp"

namespace slamd::sensors {
namespace {

constexpr Duration kBetween = std::chrono::milliseconds(10);

/// A second of 100 samples.
void add_second(InertialWatch& sut, const Eigen::Vector3d& force_mps2, Duration begin = {}, double shake_mps2 = 0.0) {
  for (int i = 0; i < 100; ++i) {
    sut.add(reading_of(begin + i * kBetween, force_mps2 + Eigen::Vector3d::Constant(i % 2 == 0 ? shake_mps2 : -shake_mps2)));
  }
  sut.end_second();
}

TEST(InertialWatch, CountsTheLastWholeSecondAndAll) {
  InertialWatch sut;

  add_second(sut, {0.0, 0.0, 9.81});
  sut.add(reading_of(std::chrono::seconds(1), {0.0, 0.0, 9.81}));

  EXPECT_EQ(sut.seen().samples, (Count{101, 100}));
  sut.end_second();
  EXPECT_EQ(sut.seen().samples, (Count{101, 1}));
}

TEST(InertialWatch, ShowsGravityAtRest) {
  InertialWatch sut;

  add_second(sut, {0.0, -9.81, 0.0});

  EXPECT_TRUE(sut.seen().shows_gravity());
  EXPECT_EQ(up_axis(sut.seen().mean_force_mps2), "-y");
}

TEST(InertialWatch, ShowsNoGravityWhileItIsShakenOrTurnsOrIsInOtherUnits) {
  InertialWatch shaken;
  InertialWatch in_g;
  InertialWatch turning;
  sensor::ImuReading turn = reading_of({}, {0.0, 0.0, 9.81});
  turn.angular_rate_radps.z() = 0.5;

  add_second(shaken, {0.0, 0.0, 9.81}, {}, 3.0);
  add_second(in_g, {0.0, 0.0, 1.0});
  for (int i = 0; i < 100; ++i) {
    turning.add(turn);
  }
  turning.end_second();

  EXPECT_FALSE(shaken.seen().shows_gravity());
  EXPECT_FALSE(in_g.seen().shows_gravity());
  EXPECT_FALSE(turning.seen().shows_gravity());
  EXPECT_FALSE(InertialWatch{}.seen().shows_gravity());
}

TEST(InertialWatch, TellsUnitsAfterASecondOfDeviceTime) {
  InertialWatch sut;

  add_second(sut, {0.0, 0.0, 1.0});
  add_second(sut, {0.0, 0.0, 1.0}, std::chrono::seconds(1));

  EXPECT_EQ(sut.seen().units, imu::Units::kInG);
}

TEST(InertialWatch, ShowsWhatTheProtocolHasCounted) {
  imu::InertialCounters counters;
  counters.frames[static_cast<std::size_t>(imu::InertialResult::kSample)] = 7;
  counters.frames[static_cast<std::size_t>(imu::InertialResult::kOther)] = 5;
  counters.frames[static_cast<std::size_t>(imu::InertialResult::kNoTime)] = 2;
  counters.frames[static_cast<std::size_t>(imu::InertialResult::kOutOfRange)] = 1;
  counters.missing = 4;
  counters.clipped = 3;

  const InertialSeen sut = InertialWatch{}.seen(counters);

  EXPECT_EQ(sut.refused, 3U);  // answers are none
  EXPECT_EQ(sut.missing, 4U);
  EXPECT_EQ(sut.clipped, 3U);
}

TEST(Gravity, ProposesTheRotationThatHasItAlongZ) {
  const Eigen::Vector3d up_imu(0.0, -9.81, 0.0);  // the sensor lies on its side

  const Gravity sut = compare_gravity(Eigen::Matrix3d::Identity(), up_imu);

  EXPECT_NEAR(sut.angle_deg, 90.0, 1e-9);
  EXPECT_NEAR((sut.rpy_deg - Eigen::Vector3d(-90.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
}

TEST(Gravity, KeepsTheYawThatIsConfigured) {
  const Eigen::Matrix3d R_base_imu = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Vector3d up_imu(9.81 * std::sin(0.3), 0.0, 9.81 * std::cos(0.3));

  const Gravity sut = compare_gravity(R_base_imu, up_imu);

  EXPECT_NEAR(sut.angle_deg, 0.3 * 180.0 / M_PI, 1e-9);
  EXPECT_NEAR(sut.rpy_deg.z(), 0.5 * 180.0 / M_PI, 2.0);
}

TEST(Gravity, IsWhereItBelongsBehindTheRightRotation) {
  const Eigen::Matrix3d R_base_imu = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();

  EXPECT_NEAR(compare_gravity(R_base_imu, {0.0, 0.0, -9.81}).angle_deg, 0.0, 1e-9);
  EXPECT_NEAR(compare_gravity(R_base_imu, {0.0, 0.0, 9.81}).angle_deg, 180.0, 1e-9);
}

}  // namespace
}  // namespace slamd::sensors
