#include "tools/study/disturbance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace slamd::study {
namespace {

TEST(Disturbance, DrawsUniformlyInItsBoxAndTellsItsCovariance) {
  const ErrorSize sut{1.0, 10.0};
  psf::Random random(1, 2);
  geometry::Vector6d square_sum = geometry::Vector6d::Zero();
  geometry::Vector6d largest = geometry::Vector6d::Zero();
  constexpr int kDraws = 20'000;

  for (int i = 0; i < kDraws; ++i) {
    const geometry::Vector6d error = error_of(sut, drawn_unit_error(random));
    square_sum += error.cwiseAbs2();
    largest = largest.cwiseMax(error.cwiseAbs());
  }

  const inertial::Covariance P = covariance_of(sut);
  const double ten_rad = 10.0 * M_PI / 180.0;
  const geometry::Vector6d box =
      (geometry::Vector6d() << 1.0, 1.0, 0.3, 0.3 * ten_rad, 0.3 * ten_rad, ten_rad).finished();
  for (int axis = 0; axis < 6; ++axis) {
    EXPECT_NEAR(square_sum[axis] / kDraws / P(axis, axis), 1.0, 0.03) << axis;
    EXPECT_LE(largest[axis], box[axis]) << axis;
    EXPECT_GT(largest[axis], 0.99 * box[axis]) << axis;
  }
  EXPECT_EQ(sut.name(), "1 m/10°");
}

TEST(Disturbance, SpoilsTheInertialSamplesAsItSays) {
  RecordedDrive drive;
  drive.imu_rate_hz = 200.0;
  const odometry::OdometryConfig config{};
  for (int i = 0; i < 40; ++i) {
    scan::DeskewedScan scan(config.preprocess);
    scan.begin = Stamp{} + std::chrono::seconds(1) + i * std::chrono::milliseconds(100);
    scan.end = scan.begin + std::chrono::milliseconds(100);
    drive.scans.push_back(scan);
  }
  for (int i = 0; i < 1200; ++i) {
    drive.imu.push_back({Stamp{} + i * std::chrono::milliseconds(5),
                         Eigen::Vector3d::Zero(),
                         Eigen::Vector3d::Zero()});
  }
  psf::Random random(5, 6);

  const Degradation sut = drawn_degradation(drive, 0, 40, random);

  const double gap_s = to_seconds(sut.gap_end - sut.gap_begin);
  EXPECT_GE(gap_s, 0.5);
  EXPECT_LE(gap_s, 2.0);
  EXPECT_GE(sut.gyro_bias_radps.norm(), 2.0 * M_PI / 180.0);
  EXPECT_LE(sut.gyro_bias_radps.norm(), 5.0 * M_PI / 180.0);
  EXPECT_GE(std::count(sut.scan_dropped.begin(), sut.scan_dropped.end(), true), 5);
  double before_square_sum = 0.0;
  int before = 0;
  Eigen::Vector3d after_sum = Eigen::Vector3d::Zero();
  int after = 0;
  for (const sensor::ImuSample& sample : sut.imu) {
    EXPECT_FALSE(sample.stamp >= sut.gap_begin && sample.stamp < sut.gap_end);
    if (sample.stamp < drive.scans[0].begin) {
      EXPECT_EQ(sample.angular_rate_radps.norm(), 0.0);
    } else if (sample.stamp < sut.bias_step_at) {
      before_square_sum += sample.angular_rate_radps.squaredNorm();
      before += 3;
    } else {
      after_sum += sample.angular_rate_radps;
      ++after;
    }
  }
  const double std_radps = drive.imu_errors.gyro_noise_radps_sqrthz * std::sqrt(200.0 * 99.0);
  EXPECT_NEAR(std::sqrt(before_square_sum / before) / std_radps, 1.0, 0.25);
  EXPECT_LT((after_sum / after - sut.gyro_bias_radps).norm(), 6.0 * std_radps / std::sqrt(after));
}

}  // namespace
}  // namespace slamd::study
