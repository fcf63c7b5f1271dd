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

}  // namespace
}  // namespace slamd::odometry
