#include "core/calibration/lidar_imu_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Cholesky>

#include "core/geometry/so3.hpp"
#include "core/inertial/propagation.hpp"
#include "core/inertial/wheel_update.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::calibration {
namespace {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;
using inertial::Covariance;
using inertial::ErrorState;
using inertial::NavState;
using sensor::ImuSample;

constexpr double kScan_s = 0.1;
constexpr double kImu_s = 0.005;
constexpr double kAttitudeNoise_rad = 2e-4;
constexpr double kPositionNoise_m = 3e-3;

/// A body that turns to and fro where it stands, as a vehicle in bends on rough ground; on a grid of a millisecond.
class TrueMotion {
 public:
  explicit TrueMotion(double duration_s) {
    R_.push_back(Eigen::Matrix3d::Identity());
    for (double t = 0.0; t < duration_s + 1.0; t += kStep_s) {
      R_.push_back(geometry::orthonormalized(R_.back() * geometry::so3_exp(rate(t + 0.5 * kStep_s) * kStep_s)));
    }
  }

  static Eigen::Vector3d rate(double t) {
    return t < kRest_s ? Eigen::Vector3d(0.0, 0.0, 0.0)
                       : Eigen::Vector3d(0.04 * std::sin(3.1 * (t - kRest_s)), 0.05 * std::sin(2.3 * (t - kRest_s)),
                                         0.4 * std::sin(0.7 * (t - kRest_s)));
  }

  Eigen::Matrix3d attitude(double t) const {
    const double place = std::max(0.0, t) / kStep_s;
    const auto i = static_cast<std::size_t>(place);
    return R_[i] * geometry::so3_exp(geometry::so3_log(R_[i].transpose() * R_[i + 1]) * (place - std::floor(place)));
  }

 private:
  static constexpr double kStep_s = 0.001;
  static constexpr double kRest_s = 1.0;
  std::vector<Eigen::Matrix3d> R_;
};

/// A filter that is led by an inertial sensor with stamps that are late and axes that are turned, and held by scans that are exact
/// but for noise, each in the mean of its time.
class Drive {
 public:
  Drive(double late_s, const Eigen::Vector3d& turned_rad, double duration_s = 62.0)
      : late_s_(late_s), turned_(geometry::so3_exp(turned_rad)), motion_(duration_s) {
    state_.gyro_bias = Eigen::Vector3d(0.001, -0.002, 0.001);
    P_.setZero();
    P_.diagonal() << Eigen::Vector3d::Constant(1e-8), Eigen::Vector3d::Constant(1e-8), Eigen::Vector3d::Constant(1e-4),
        Eigen::Vector3d::Constant(1e-5), Eigen::Vector3d::Constant(4e-3), Eigen::Vector2d::Constant(1e-4);
    sut.begin(state_);
    for (double t = kScan_s; t < duration_s; t += kScan_s) {
      scan(t);
    }
  }

  LidarImuCheck sut;

 private:
  static Stamp at(double t) { return Stamp{from_seconds(t)}; }

  ImuSample sample(double t) const {
    const Eigen::Vector3d bias(0.001, -0.002, 0.001);
    ImuSample sample;
    sample.stamp = at(t);
    sample.angular_rate_radps = turned_ * TrueMotion::rate(t - late_s_) + bias;
    sample.specific_force_mps2 = turned_ * (motion_.attitude(t - late_s_).transpose() * Eigen::Vector3d(0, 0, inertial::kGravityMps2));
    return sample;
  }

  void scan(double end_s) {
    samples_.clear();
    for (double t = end_s - kScan_s - kImu_s; t < end_s + 2.0 * kImu_s; t += kImu_s) {
      samples_.push_back(sample(t));
    }
    const NavState before = state_;
    wheels_.begin_transition();
    inertial::propagate(state_, P_, samples_, at(end_s - 0.5 * kScan_s), noise_, &wheels_.followers());
    const Eigen::Matrix3d R_middle = state_.T_odom_imu.rotation();
    inertial::propagate(state_, P_, samples_, at(end_s), noise_, &wheels_.followers());

    Se3 seen = state_.T_odom_imu;
    seen.translation() = kPositionNoise_m * normal3();
    seen.rotation() = motion_.attitude(end_s - 0.5 * kScan_s) * R_middle.transpose() * state_.T_odom_imu.rotation() *
                      geometry::so3_exp(kAttitudeNoise_rad * normal3());
    Matrix6d information = Matrix6d::Zero();
    information.diagonal() << Eigen::Vector3d::Constant(1.0 / (kPositionNoise_m * kPositionNoise_m)),
        Eigen::Vector3d::Constant(1.0 / (kAttitudeNoise_rad * kAttitudeNoise_rad));
    Covariance inverse = P_.ldlt().solve(Covariance::Identity());
    inverse.topLeftCorner<6, 6>() += information;
    const Covariance P = inverse.ldlt().solve(Covariance::Identity());
    const ErrorState correction = P.leftCols<6>() * (information * geometry::boxminus(seen, state_.T_odom_imu));
    const NavState posterior = inertial::boxplus(state_, correction);
    sut.add({before, state_, wheels_.transition(), posterior, P, information});
    state_ = posterior;
    P_ = 0.5 * (P + P.transpose());
  }

  Eigen::Vector3d normal3() { return {normal_(random_), normal_(random_), normal_(random_)}; }

  double late_s_;
  Eigen::Matrix3d turned_;
  TrueMotion motion_;
  NavState state_;
  Covariance P_;
  inertial::ImuNoise noise_;
  inertial::WheelUpdate wheels_{inertial::WheelConfig{}};
  std::vector<ImuSample> samples_;
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
};

class LateStamps : public testing::TestWithParam<double> {};

TEST_P(LateStamps, AreFoundToHalfAMillisecond) {
  const Drive drive(GetParam(), Eigen::Vector3d::Zero());

  const LidarImuAgreement agreement = drive.sut.agreement();

  ASSERT_TRUE(agreement.known);
  EXPECT_NEAR(agreement.offset_s.value, GetParam(), 5e-4);
  EXPECT_LT(std::abs(agreement.offset_s.value - GetParam()), 3.0 * agreement.offset_s.std);
  for (const Estimate& about : agreement.rotation_rad) {
    EXPECT_LT(std::abs(about.value), 3.0 * about.std);
  }
}

INSTANTIATE_TEST_SUITE_P(Offsets, LateStamps, testing::Values(0.0, 0.003, 0.008, -0.015));

TEST(LidarImuCheck, FindsHowTheSensorIsTurned) {
  const Eigen::Vector3d turned_rad(0.035, -0.052, 0.0);
  const Drive drive(0.0, turned_rad);

  const LidarImuAgreement agreement = drive.sut.agreement();

  ASSERT_TRUE(agreement.known);
  EXPECT_NEAR(agreement.rotation_rad[0].value, turned_rad.x(), 0.004);
  EXPECT_NEAR(agreement.rotation_rad[1].value, turned_rad.y(), 0.004);
  EXPECT_TRUE(agreement.rotation_rad[0].stands_out(0.017));
  EXPECT_TRUE(agreement.rotation_rad[1].stands_out(0.017));
  EXPECT_FALSE(agreement.offset_s.stands_out(1e-3));
}

TEST(LidarImuCheck, KnowsNothingAfterHalfAMinute) {
  EXPECT_FALSE(Drive(0.008, Eigen::Vector3d::Zero(), 35.0).sut.agreement().known);
}

TEST(LidarImuCheck, KnowsNothingOfAVehicleThatStands) {
  LidarImuCheck sut;
  NavState state;
  sut.begin(state);
  const inertial::Transition transition = inertial::Transition::Identity();
  const Covariance P = 1e-6 * Covariance::Identity();
  for (int i = 0; i < 700; ++i) {
    const NavState before = state;
    state.stamp += from_seconds(kScan_s);
    sut.add({before, state, transition, state, P, 1e6 * Matrix6d::Identity()});
  }

  EXPECT_GE(sut.agreement().windows, 4);
  EXPECT_FALSE(sut.agreement().known);
}

TEST(LidarImuCheck, KeepsWhatItKnowsWhenTheThreadIsLost) {
  Drive drive(0.008, Eigen::Vector3d::Zero());
  const double before = drive.sut.agreement().offset_s.value;

  drive.sut.begin(NavState{});

  EXPECT_EQ(drive.sut.agreement().offset_s.value, before);
}

TEST(LidarImuCheck, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  LidarImuCheck sut;
  NavState before;
  NavState state;
  state.stamp += from_seconds(kScan_s);
  const inertial::Transition transition = inertial::Transition::Identity();
  const Covariance P = 1e-6 * Covariance::Identity();

  LidarImuAgreement agreement;
  const std::size_t allocations = support::count_allocations([&] {
    sut.begin(before);
    for (int i = 0; i < 250; ++i) {
      sut.add({before, state, transition, state, P, Matrix6d::Identity()});
      before.stamp = state.stamp;
      state.stamp += from_seconds(kScan_s);
    }
    agreement = sut.agreement();
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(agreement.windows, 2);
}

}  // namespace
}  // namespace slamd::calibration
