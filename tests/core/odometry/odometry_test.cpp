#include "core/odometry/odometry.hpp"

#include <gtest/gtest.h>

#include "core/odometry/environment.hpp"

namespace slamd::odometry {
namespace {

TEST(EnvironmentEstimate, SwitchesWithHysteresis) {
  EnvironmentEstimate sut(Environment::kAuto, 8.0, 12.0);
  const auto feed = [&](float range_m) {
    for (int i = 0; i < 10; ++i) {
      sut.add(range_m);
    }
  };

  feed(10.0F);
  EXPECT_FALSE(sut.indoor());
  feed(6.0F);
  EXPECT_TRUE(sut.indoor());
  feed(10.0F);
  EXPECT_TRUE(sut.indoor());
  feed(14.0F);
  EXPECT_FALSE(sut.indoor());
}

TEST(EnvironmentEstimate, KeepsWhatWasConfigured) {
  EnvironmentEstimate sut(Environment::kIndoor, 8.0, 12.0);

  for (int i = 0; i < 20; ++i) {
    sut.add(50.0F);
  }

  EXPECT_TRUE(sut.indoor());
}

TEST(Odometry, SaysDegradedWithItsCauseWhenTheScanMeetsNothing) {
  OdometryConfig config;
  config.use_imu = false;
  Odometry sut(config);
  sut.start_without_imu(Stamp{});
  scan::DeskewedScan scan(config.preprocess);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f p(0.1F * static_cast<float>(i % 20), 0.1F * static_cast<float>(i / 20), -1.0F);
    scan.planar.push_back({p, 2.0F});
    scan.map_points_imu.push_back(p);
  }
  scan.end = Stamp{} + std::chrono::milliseconds(100);
  sut.process(scan, {});
  for (scan::FeaturePoint& feature : scan.planar) {
    feature.p_imu.z() += 30.0F;
  }
  scan.end += std::chrono::milliseconds(100);
  ++scan.index;

  const OdometryResult first = sut.process(scan, {});
  OdometryResult last = first;
  for (int i = 0; i < config.lost_after; ++i) {
    scan.end += std::chrono::milliseconds(100);
    last = sut.process(scan, {});
  }

  EXPECT_EQ(first.state, State::kDegraded);
  EXPECT_EQ(first.cause, Cause::kFewConstraints);
  EXPECT_FALSE(first.map_updated);
  EXPECT_EQ(last.state, State::kLost);
}

/// An odometry without inertial sensor that stands in a room: five scans of three walls and the floor.
struct RoomFixture {
  OdometryConfig config;
  scan::DeskewedScan scan;
  Odometry sut;
  OdometryResult last;

  RoomFixture() : config(lidar_only()), scan(config.preprocess), sut(config) {
    sut.start_without_imu(Stamp{});
    for (int i = 0; i < 3 * 625; ++i) {
      const float a = 0.16F * static_cast<float>(i % 25) - 2.0F;
      const float b = 0.16F * static_cast<float>(i / 25 % 25) - 2.0F;
      const Eigen::Vector3f p = i < 625       ? Eigen::Vector3f(a, b, -1.0F)
                                : i < 2 * 625 ? Eigen::Vector3f(3.1F, a, b)
                                              : Eigen::Vector3f(a, 3.1F, b);
      scan.planar.push_back({p, p.norm()});
      scan.map_points_imu.push_back(p);
    }
    for (int i = 0; i < 5; ++i) {
      add(std::chrono::milliseconds(100));
    }
  }

  static OdometryConfig lidar_only() {
    OdometryConfig config;
    config.use_imu = false;
    return config;
  }

  void move_scan(const Eigen::Vector3f& by) {
    for (scan::FeaturePoint& feature : scan.planar) {
      feature.p_imu += by;
    }
    for (Eigen::Vector3f& p : scan.map_points_imu) {
      p += by;
    }
  }

  void add(Duration after, std::span<const sensor::ImuSample> samples = {}) {
    scan.begin = scan.end + after - std::chrono::milliseconds(100);
    scan.end += after;
    ++scan.index;
    last = sut.process(scan, samples);
  }
};

TEST(Odometry, LetsTheMapGrowAfterABlackoutOnlyOnceTheMapHasAgreed) {
  RoomFixture fixture;
  ASSERT_TRUE(fixture.last.map_updated);

  fixture.add(std::chrono::seconds(2));
  EXPECT_EQ(fixture.last.state, State::kDegraded);
  EXPECT_EQ(fixture.last.cause, Cause::kUnconfirmed);
  EXPECT_FALSE(fixture.last.map_updated);
  for (int i = 1; i < fixture.config.confirming_scans; ++i) {
    fixture.add(std::chrono::milliseconds(100));
  }

  EXPECT_EQ(fixture.last.state, State::kTracking);
  EXPECT_TRUE(fixture.last.map_updated);
  EXPECT_EQ(fixture.last.map_restarts, 0U);
}

TEST(Odometry, BeginsTheMapAnewWhereItDoesNotMeetTheOldOneAndSaysSo) {
  RoomFixture fixture;
  fixture.move_scan({100.0F, 0.0F, 0.0F});

  fixture.add(std::chrono::seconds(2));
  for (int i = 1; i < fixture.config.restart_map_unmet_after; ++i) {
    EXPECT_FALSE(fixture.last.map_updated);
    fixture.add(std::chrono::milliseconds(100));
  }

  EXPECT_EQ(fixture.last.map_restarts, 1U);
  EXPECT_EQ(fixture.last.state, State::kDegraded);
  EXPECT_EQ(fixture.last.cause, Cause::kMapRestarted);
}

/// Samples of an inertial sensor that turns about its vertical, for the 100 ms before `end`.
std::vector<sensor::ImuSample> samples_to(Stamp end, double rate_radps) {
  std::vector<sensor::ImuSample> samples;
  for (Stamp now = end - std::chrono::milliseconds(100); now <= end; now += std::chrono::milliseconds(10)) {
    samples.push_back({now, {0.0, 0.0, rate_radps}, {0.0, 0.0, inertial::kGravityMps2}});
  }
  return samples;
}

TEST(Odometry, LetsTheMapConfirmAPoseThatTheInertialSensorDidNotExpect) {
  OdometryConfig config;
  Odometry sut(config);
  RoomFixture room;
  sut.start({});
  const auto add = [&] {
    room.scan.begin = room.scan.end;
    room.scan.end += std::chrono::milliseconds(100);
    ++room.scan.index;
    return sut.process(room.scan, samples_to(room.scan.end, 0.0));
  };
  room.scan.end = Stamp{};
  for (int i = 0; i < 5; ++i) {
    add();
  }
  room.move_scan({0.3F, 0.26F, 0.2F});

  const OdometryResult jump = add();

  EXPECT_NEAR(jump.T_odom_base.translation().x(), -0.3, 0.02);
  EXPECT_NEAR(jump.T_odom_base.translation().y(), -0.26, 0.02);
  EXPECT_EQ(jump.cause, Cause::kUnconfirmed);
  EXPECT_FALSE(jump.map_updated);
  OdometryResult last;
  for (int i = 1; i < config.confirming_scans; ++i) {
    last = add();
  }
  EXPECT_EQ(last.state, State::kTracking);
  EXPECT_TRUE(last.map_updated);
}

TEST(Odometry, DoesNotTrustAnInertialSensorAtItsLimit) {
  OdometryConfig config;
  Odometry sut(config);
  RoomFixture room;
  sut.start({});
  scan::DeskewedScan& scan = room.scan;
  scan.begin = Stamp{};
  scan.end = Stamp{} + std::chrono::milliseconds(100);
  sut.process(scan, samples_to(scan.end, 0.0));
  scan.begin = scan.end;
  scan.end += std::chrono::milliseconds(100);

  const OdometryResult result = sut.process(scan, samples_to(scan.end, 1.5));

  EXPECT_EQ(result.state, State::kDegraded);
  EXPECT_EQ(result.cause, Cause::kSaturated);
  EXPECT_FALSE(result.map_updated);
}

}  // namespace
}  // namespace slamd::odometry
