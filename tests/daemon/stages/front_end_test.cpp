#include "daemon/stages/front_end.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/geometry/so3.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/world/room.hpp"

namespace slamd::stages {
namespace {

using geometry::Se3;
using odometry::Filter;
using odometry::OdometryConfig;
using odometry::OdometryResult;
using odometry::State;
using sensor::ImuSample;

/// A vehicle that stands for a second and then drives a circle in the hall, speeding up smoothly; lidar = imu = base.
struct Drive {
  double radius_m = 3.0;
  double top_speed_mps = 1.2;
  double rest_s = 1.5;

  double angle_rad(double t_s) const {
    const double t = std::max(0.0, t_s - rest_s);
    // The speed rises over two seconds with a continuous slope.
    const double ramp = t < 2.0 ? t * t * t / 4.0 - t * t * t * t / 16.0 : t - 1.0;
    return top_speed_mps * ramp / radius_m;
  }

  Se3 pose(double t_s) const {
    const double a = angle_rad(t_s);
    return {geometry::rotation_from_rpy({0.0, 0.0, a}),
            Eigen::Vector3d(radius_m * std::sin(a), radius_m * (1.0 - std::cos(a)) - 3.0, 1.0)};
  }

  ImuSample imu(double t_s) const {
    constexpr double kStep = 1e-3;
    const auto p = [&](double t) { return pose(t).translation(); };
    const Eigen::Vector3d acceleration = (p(t_s + kStep) - 2.0 * p(t_s) + p(t_s - kStep)) / (kStep * kStep);
    const double rate = (angle_rad(t_s + kStep) - angle_rad(t_s - kStep)) / (2.0 * kStep);
    const Eigen::Vector3d force = acceleration + Eigen::Vector3d(0.0, 0.0, inertial::kGravityMps2);
    return {Stamp{} + from_seconds(t_s), {0.0, 0.0, rate}, pose(t_s).rotation().transpose() * force};
  }
};

struct Outcome {
  double worst_m = 0.0;  // after the first pose was laid on the truth
  double worst_rad = 0.0;
  int scans = 0;
  int degraded = 0;
  int starts = 0;        // the figures are of the time since the last one
  double start_m = 0.0;  // from odom's origin
  std::size_t allocations = 0;
  Se3 T_odom_base_last;
};

OdometryConfig small_config() {
  OdometryConfig config;
  config.preprocess.max_points = 20'000;
  return config;
}

/// Drives through the room; `silent(t)` tells when the inertial sensor says nothing.
template <typename Silent>
Outcome follow(const OdometryConfig& config, double seconds, Silent&& silent, const Drive& drive = {}, int restart_scan = -1) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  const world::Room room;
  const Eigen::Vector3d gyro_bias(0.003, -0.002, 0.004);
  const Eigen::Vector3d accel_bias(0.05, -0.08, 0.06);
  FrontEnd sut(config);
  Outcome outcome;
  Se3 T_world_odom;
  int next_imu = 0;
  for (int k = 0; 0.1 * (k + 1) < seconds; ++k) {
    const Stamp begin = Stamp{} + k * std::chrono::milliseconds(100);
    for (; 0.005 * next_imu <= 0.1 * (k + 1); ++next_imu) {
      ImuSample sample = drive.imu(0.005 * next_imu);
      for (int axis = 0; axis < 3; ++axis) {
        sample.angular_rate_radps[axis] += gyro_bias[axis] + 0.003 * normal(engine);
        sample.specific_force_mps2[axis] += accel_bias[axis] + 0.025 * normal(engine);
      }
      if (!silent(0.005 * next_imu)) {
        sut.add_imu(sample);
      }
    }
    const sensor::Scan scan = room.scan(begin, std::chrono::milliseconds(100), 600, 0.01, engine,
                                        [&](double t) { return drive.pose(0.1 * k + t); });
    std::optional<OdometryResult> result;
    outcome.allocations += support::count_allocations([&] {
      if (k == restart_scan) {
        sut.restart(2);
      }
      result = sut.process(scan);
    });
    if (!result) {
      outcome.scans = 0;
      outcome.worst_m = 0.0;
      continue;
    }
    const Se3 truth = drive.pose(0.1 * (k + 1));
    if (outcome.scans++ == 0) {
      ++outcome.starts;
      outcome.start_m = result->T_odom_base.translation().norm();
      T_world_odom = truth * result->T_odom_base.inverse();
    }
    const geometry::Vector6d error = geometry::boxminus(T_world_odom * result->T_odom_base, truth);
    outcome.worst_m = std::max(outcome.worst_m, error.head<3>().norm());
    outcome.worst_rad = std::max(outcome.worst_rad, error.tail<3>().norm());
    outcome.degraded += result->state == State::kDegraded ? 1 : 0;
    outcome.T_odom_base_last = result->T_odom_base;
  }
  return outcome;
}

const auto kNeverSilent = [](double) { return false; };

TEST(FrontEnd, FollowsADriveWithinCentimetres) {
  for (const Filter filter : {Filter::kPsf, Filter::kIekf}) {
    OdometryConfig config = small_config();
    config.filter = filter;

    const Outcome outcome = follow(config, 12.0, kNeverSilent);

    EXPECT_GT(outcome.scans, 100);
    EXPECT_LT(outcome.worst_m, 0.05);  // a thin scan: 600 columns of 16 lines
    EXPECT_LT(outcome.worst_rad, 0.006);
    EXPECT_EQ(outcome.degraded, 0);
  }
}

TEST(FrontEnd, FollowsADriveWithoutInertialSensor) {
  OdometryConfig config = small_config();
  config.use_imu = false;

  const Outcome outcome = follow(config, 12.0, kNeverSilent);

  EXPECT_LT(outcome.worst_m, 0.08);
  EXPECT_LT(outcome.worst_rad, 0.02);
}

TEST(FrontEnd, StartsWithoutInertialSensorAtTheFirstCompleteScanButDoesNotWaitForEver) {
  OdometryConfig config = small_config();
  config.use_imu = false;
  std::mt19937_64 engine(11);
  const world::Room room;
  const auto scan_of = [&](int k, bool complete) {
    sensor::Scan scan = room.scan(Stamp{} + k * std::chrono::milliseconds(100), std::chrono::milliseconds(100), 600, 0.01,
                                  engine, [](double) { return Drive().pose(0.0); });
    scan.complete = complete;
    return scan;
  };
  FrontEnd patient(config);
  FrontEnd lossy(config);

  EXPECT_FALSE(patient.process(scan_of(0, false)));
  EXPECT_TRUE(patient.process(scan_of(1, true)));
  EXPECT_TRUE(patient.process(scan_of(2, false)));
  for (int k = 0; k < PreprocessStage::kIncompletePatience; ++k) {
    EXPECT_FALSE(lossy.process(scan_of(k, false))) << k;
  }
  EXPECT_TRUE(lossy.process(scan_of(PreprocessStage::kIncompletePatience, false)));
}

TEST(FrontEnd, SurvivesSilenceOfTheInertialSensorAndItsReturn) {
  const Outcome outcome = follow(small_config(), 12.0, [](double t) { return t > 5.0 && t < 7.0; });

  EXPECT_GE(outcome.degraded, 15);
  EXPECT_LE(outcome.degraded, 30);
  EXPECT_LT(outcome.worst_m, 0.10);
}

TEST(FrontEnd, BeginsOdomAndMapAnewWhenToldToAndForgetsWhatWasBefore) {
  Drive drive;
  drive.rest_s = 3.0;

  const Outcome outcome = follow(small_config(), 6.0, kNeverSilent, drive, 15);

  EXPECT_EQ(outcome.starts, 2);
  EXPECT_LT(outcome.start_m, 0.05);
  EXPECT_GT(outcome.scans, 25);
  EXPECT_LT(outcome.worst_m, 0.05);
  EXPECT_EQ(outcome.allocations, 0U);
}

/// The same vehicle, whose LiDAR says nothing from `from_s` to `to_s`.
struct SilentLidar {
  Drive drive;
  double from_s = 3.0;
  double to_s = 63.0;
  bool imu_too = false;
  std::vector<double> wild_s;           // before these, a sample of both kinds that is stamped an hour ahead

  std::vector<OdometryResult> steps;    // without a scan
  std::vector<OdometryResult> results;  // after the silence
  double error_m = 0.0;                 // of the last pose
  std::size_t allocations = 0;

  void run(double seconds) {
    std::mt19937_64 engine(12);
    std::normal_distribution<double> normal;
    const world::Room room;
    FrontEnd sut(small_config());
    std::optional<Se3> T_world_odom;
    int next_imu = 0;
    for (int k = 0; 0.1 * (k + 1) < seconds; ++k) {
      const double end_s = 0.1 * (k + 1);
      const bool silent = end_s > from_s && end_s <= to_s;
      for (; 0.005 * next_imu <= end_s; ++next_imu) {
        ImuSample sample = drive.imu(0.005 * next_imu);
        for (int axis = 0; axis < 3; ++axis) {
          sample.angular_rate_radps[axis] += 0.003 + 0.003 * normal(engine);
          sample.specific_force_mps2[axis] += 0.05 + 0.025 * normal(engine);
        }
        if (silent && imu_too) {
          continue;
        }
        for (const double wild : wild_s) {
          if (std::abs(0.005 * next_imu - wild) < 0.0025) {
            sut.add_imu({sample.stamp + std::chrono::hours(1), sample.angular_rate_radps, sample.specific_force_mps2});
            sut.add_wheel({sample.stamp + std::chrono::hours(1), 0.0, 0.0});
          }
        }
        if (!wild_s.empty() && next_imu % 20 == 0) {
          sut.add_wheel({sample.stamp, 0.0, 0.0});
        }
        sut.add_imu(sample);
        std::optional<OdometryResult> step;
        do {
          allocations += support::count_allocations([&] { step = sut.go_on_without_scan(); });
          if (step) {
            steps.push_back(*step);
          }
        } while (step);
      }
      if (silent) {
        continue;
      }
      const sensor::Scan scan = room.scan(Stamp{} + k * std::chrono::milliseconds(100), std::chrono::milliseconds(100), 600,
                                          0.01, engine, [&](double t) { return drive.pose(0.1 * k + t); });
      if (const auto result = sut.process(scan)) {
        T_world_odom = T_world_odom.value_or(drive.pose(end_s) * result->T_odom_base.inverse());
        error_m = (*T_world_odom * result->T_odom_base.translation() - drive.pose(end_s).translation()).norm();
        if (end_s > to_s) {
          results.push_back(*result);
        }
      }
    }
  }
};

TEST(FrontEnd, RefusesNoSampleOfSlowWheels) {
  FrontEnd sut(small_config());
  for (int i = 0; i < 20; ++i) {
    sut.add_wheel({Stamp{} + i * std::chrono::milliseconds(1100), 0.0, 0.0});
  }

  EXPECT_EQ(sut.wheels_refused(), 0U);
}

TEST(FrontEnd, TracksAgainAtOnceAfterAMinuteWithoutScansAtRest) {
  SilentLidar sut;
  sut.drive.rest_s = 100.0;

  sut.run(64.0);

  ASSERT_GT(sut.steps.size(), 590U);
  EXPECT_EQ(sut.steps.back().state, State::kDegraded);
  EXPECT_EQ(sut.steps.back().cause, odometry::Cause::kNoLidar);
  EXPECT_LT(std::sqrt(sut.steps.back().P_odom_base.diagonal().head<3>().maxCoeff()), 0.15);
  ASSERT_GT(sut.results.size(), 5U);
  EXPECT_EQ(sut.results[3].state, State::kTracking) << name_of(sut.results[3].cause);
  EXPECT_EQ(sut.results.back().map_restarts, 0U);
  EXPECT_LT(sut.error_m, 0.02);
}

TEST(FrontEnd, TracksAgainAfterAMinuteInWhichNoSensorSpokeAtRest) {
  SilentLidar sut;
  sut.drive.rest_s = 100.0;
  sut.imu_too = true;

  sut.run(65.0);

  ASSERT_GT(sut.results.size(), 15U);
  EXPECT_NE(sut.results.front().state, State::kTracking);  // it may have been carried away
  EXPECT_EQ(sut.results.back().state, State::kTracking) << name_of(sut.results.back().cause);
  EXPECT_EQ(sut.results.back().map_restarts, 0U);
  EXPECT_LT(sut.error_m, 0.02);
}

TEST(FrontEnd, IsLostAfterLongWithoutScansInADriveAndNeverBelievesAWrongPose) {
  SilentLidar sut;
  sut.drive.rest_s = 1.5;
  sut.from_s = 6.0;
  sut.to_s = 46.0;

  sut.run(50.0);

  ASSERT_GT(sut.steps.size(), 390U);
  EXPECT_EQ(sut.steps.front().state, State::kDegraded);
  EXPECT_EQ(sut.steps.back().state, State::kLost);
  EXPECT_EQ(sut.steps.back().cause, odometry::Cause::kNoLidar);
  EXPECT_EQ(sut.results.front().state, State::kLost);
  EXPECT_TRUE(sut.results.back().state != State::kTracking || sut.error_m < 0.1);
}

TEST(FrontEnd, DoesNotAllocateWhileItGoesOnWithoutScans) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  SilentLidar sut;
  sut.drive.rest_s = 100.0;

  sut.run(6.0);

  EXPECT_GT(sut.steps.size(), 20U);
  EXPECT_EQ(sut.allocations, 0U);
}

TEST(FrontEnd, LevelsOdomAnewUntilTheFirstScanComes) {
  SilentLidar sut;
  sut.drive.rest_s = 100.0;
  sut.from_s = 0.0;
  sut.to_s = 60.0;

  sut.run(61.0);

  ASSERT_GT(sut.results.size(), 5U);
  EXPECT_EQ(sut.results.back().state, State::kTracking);
  EXPECT_LT(sut.results.back().T_odom_base.translation().norm(), 0.02);
}

TEST(FrontEnd, GivesTheSameBitsTwice) {
  const Outcome first = follow(small_config(), 4.0, kNeverSilent);
  const Outcome second = follow(small_config(), 4.0, kNeverSilent);

  EXPECT_EQ(first.T_odom_base_last.translation(), second.T_odom_base_last.translation());
  EXPECT_EQ(first.T_odom_base_last.rotation(), second.T_odom_base_last.rotation());
}

TEST(FrontEnd, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();

  const Outcome outcome = follow(small_config(), 3.0, kNeverSilent);

  EXPECT_GT(outcome.scans, 10);
  EXPECT_EQ(outcome.allocations, 0U);
}

TEST(FrontEnd, TracksOnAfterWildStampsOfInertialSensorAndWheels) {
  SilentLidar sut;
  sut.drive.rest_s = 100.0;
  sut.from_s = sut.to_s = 2.0;
  sut.wild_s = {1e-3, 3.0, 4.0};  // the first sample of all, and two later ones

  sut.run(6.0);

  EXPECT_TRUE(sut.steps.empty());
  ASSERT_GT(sut.results.size(), 35U);
  for (const OdometryResult& result : sut.results) {
    EXPECT_EQ(result.state, State::kTracking) << name_of(result.cause);
  }
  EXPECT_LT(sut.error_m, 0.02);
}

TEST(FrontEnd, KeepsTheNewestSamplesOfALongWaitForTheFirstScan) {
  PreprocessStage sut{small_config()};
  PreprocessedScan out{small_config()};
  const auto sample_at = [](int i) { return ImuSample{Stamp{} + std::chrono::milliseconds(i), {}, {0.0, 0.0, 9.81}}; };
  for (int i = 0; i < 4100; ++i) {  // one more than fit would have emptied it
    sut.add_imu(sample_at(i));
  }
  std::mt19937_64 engine(13);
  const world::Room room;

  const Stamp begin = Stamp{} + std::chrono::milliseconds(3990);
  ASSERT_TRUE(sut.process(room.scan(begin, std::chrono::milliseconds(100), 600, 0.01, engine,
                                    [](double) { return Se3(Eigen::Matrix3d::Identity(), {0.0, 0.0, 1.0}); }), out));

  ASSERT_GT(out.imu.size(), 2000U);
  EXPECT_LE(out.imu[0].stamp, begin);
  EXPECT_EQ(out.imu.back().stamp, sample_at(4099).stamp);
}

TEST(FrontEnd, WaitsForInertialSamplesButNotForEver) {
  FrontEnd sut(small_config());
  sensor::Scan scan(10);
  scan.end = Stamp{} + std::chrono::milliseconds(100);
  sut.add_imu({scan.end - std::chrono::milliseconds(5), {}, {0.0, 0.0, 9.8}});

  EXPECT_FALSE(sut.ready_for(scan, scan.end + std::chrono::milliseconds(1)));
  EXPECT_TRUE(sut.ready_for(scan, scan.end + PreprocessStage::kImuPatience));
  sut.add_imu({scan.end, {}, {0.0, 0.0, 9.8}});
  EXPECT_TRUE(sut.ready_for(scan, scan.end + std::chrono::milliseconds(1)));
}

}  // namespace
}  // namespace slamd::stages
