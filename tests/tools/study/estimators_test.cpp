#include <gtest/gtest.h>

#include <random>

#include <Eigen/Eigenvalues>

#include "core/geometry/so3.hpp"
#include "tests/world/room.hpp"
#include "tools/study/ekf.hpp"
#include "tools/study/literal_psf.hpp"
#include "tools/study/plain_particle_filter.hpp"
#include "tools/study/study_odometry.hpp"

namespace slamd::study {
namespace {

using geometry::Se3;
using geometry::Vector6d;

const Se3 kTruth(geometry::so3_exp({0.02, -0.01, 0.7}), Eigen::Vector3d(0.5, -0.5, 1.0));

/// A room with a map, and a scan in it.
class EstimatorInARoom : public testing::Test {
 protected:
  EstimatorInARoom()
      : map_(map::VoxelMapConfig{.max_cells = 4'000, .max_surface_cells = 8'000}),
        scan_(config_.preprocess) {
    std::mt19937_64 engine(1);
    for (int i = 0; i < 16; ++i) {
      const Se3 T_odom_imu(geometry::so3_exp({0.05 * i, 0.03 * i, 0.5 * i}),
                           Eigen::Vector3d(0.25 * i - 1.5, 0.1 * i - 0.5, 1.2));
      std::vector<Eigen::Vector3f> points =
          world::Room().points_lidar(T_odom_imu, 720, 0.01, engine);
      for (Eigen::Vector3f& p : points) {
        p = (T_odom_imu * p.cast<double>()).cast<float>();
      }
      map_.insert(points, 0.0);
    }
    for (const Eigen::Vector3f& p : world::Room().points_lidar(kTruth, 50, 0.01, engine)) {
      scan_.planar.push_back({p, p.norm()});
    }
    points_imu_ = likelihood_points(scan_, config_.psf.points);
    P_.diagonal().setConstant(1e-4);
  }

  /// What is left of an error of the prior.
  Vector6d left_by(Estimator& sut, const Vector6d& error, bool indoor) {
    inertial::NavState prior;
    prior.T_odom_imu = geometry::boxplus(kTruth, error);
    result_ = sut.update({prior, P_, scan_, map_, points_imu_, indoor, 7});
    return geometry::boxminus(result_.state.T_odom_imu, kTruth);
  }

  void tell(double position_m, double rotation_rad) {
    P_.diagonal().head<3>().setConstant(position_m * position_m);
    P_.diagonal().segment<3>(3).setConstant(rotation_rad * rotation_rad);
  }

  odometry::OdometryConfig config_;
  map::VoxelMap map_;
  scan::DeskewedScan scan_;
  std::vector<Eigen::Vector3f> points_imu_;
  inertial::Covariance P_ = inertial::Covariance::Zero();
  odometry::UpdateResult result_;
};

Vector6d small_error() {
  return (Vector6d() << 0.03, -0.02, 0.01, 0.003, -0.002, 0.005).finished();
}

void expect_recovered(const Vector6d& left, double limit_m, double limit_rad) {
  EXPECT_LT(left.head<3>().norm(), limit_m);
  EXPECT_LT(left.tail<3>().norm(), limit_rad);
}

TEST_F(EstimatorInARoom, EkfRecoversASmallOffset) {
  Ekf sut(config_);

  expect_recovered(left_by(sut, small_error(), true), 0.01, 0.002);
  EXPECT_TRUE(result_.enough);
}

TEST_F(EstimatorInARoom, CoarseToFineEkfRecoversASmallOffsetAndAWrongPrior) {
  CoarseToFineEkf sut(config_);
  const Vector6d wrong = (Vector6d() << 0.6, 0.3, 0.0, 0.0, 0.0, 0.08).finished();

  expect_recovered(left_by(sut, small_error(), true), 0.01, 0.002);
  expect_recovered(left_by(sut, wrong, true), 0.02, 0.004);
}

// What particles alone can tell: cells of half a metre and some hundred points leave centimetres.

TEST_F(EstimatorInARoom, PlainParticleFilterRecoversAnOffsetThatItWasTold) {
  PlainParticleFilter sut(config_);
  tell(0.1, 0.015);

  expect_recovered(left_by(sut, 4.0 * small_error(), true), 0.06, 0.018);
  EXPECT_TRUE(result_.enough);
}

TEST_F(EstimatorInARoom, LiteralPsfRecoversAnOffsetThatItWasToldInBothReadings) {
  tell(0.1, 0.015);
  for (const TimeSteps time_steps : {TimeSteps::kWholeScan, TimeSteps::kSlices}) {
    LiteralPsf sut(config_, time_steps);

    expect_recovered(left_by(sut, 3.0 * small_error(), false), 0.04, 0.01);
    EXPECT_TRUE(result_.enough);
  }
}

TEST_F(EstimatorInARoom, LiteralPsfDoesNotFindWhatLiesFarOutsideItsSquare) {
  LiteralPsf sut(config_, TimeSteps::kWholeScan);
  const Vector6d far = (Vector6d() << 1.0, 0.8, 0.0, 0.0, 0.0, 0.17).finished();

  EXPECT_GT(left_by(sut, far, false).head<3>().norm(), 0.3);
}

TEST_F(EstimatorInARoom, SameSeedSamePosterior) {
  PlainParticleFilter a(config_);
  PlainParticleFilter b(config_);

  EXPECT_EQ(left_by(a, small_error(), true), left_by(b, small_error(), true));
}

TEST_F(EstimatorInARoom, PosteriorsOfParticlesAreCovariances) {
  P_.diagonal().setConstant(1e-3);
  P_(inertial::kVelocity, 0) = P_(0, inertial::kVelocity) = 5e-4;
  PlainParticleFilter sut(config_);

  left_by(sut, small_error(), true);

  EXPECT_EQ(result_.P, result_.P.transpose().eval());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<inertial::Covariance>(result_.P).eigenvalues().minCoeff(),
            0.0);
  EXPECT_LT(result_.P(0, 0), P_(0, 0));
  EXPECT_LT(result_.P(inertial::kVelocity, inertial::kVelocity),
            P_(inertial::kVelocity, inertial::kVelocity));
  EXPECT_NEAR(result_.P(inertial::kGyroBias, inertial::kGyroBias), 1e-3, 1e-9);
}

/// An odometry that stands in the room.
class StudyOdometryInARoom : public EstimatorInARoom {
 protected:
  StudyOdometryInARoom() : small_(small_maps(config_)), sut_(small_) {
    for (const Eigen::Vector3f& p : points_of_scan()) {
      scan_.map_points_imu.push_back(p);
    }
    sut_.start_without_imu(Stamp{});
    for (int i = 0; i < 5; ++i) {
      advance(sut_);
    }
  }

  static odometry::OdometryConfig small_maps(odometry::OdometryConfig config) {
    config.use_imu = false;
    config.map.max_cells = 4'000;
    config.map.max_surface_cells = 8'000;
    return config;
  }

  std::vector<Eigen::Vector3f> points_of_scan() const {
    std::mt19937_64 engine(3);
    return world::Room().points_lidar(kTruth, 600, 0.01, engine);
  }

  void advance(StudyOdometry& odometry) {
    scan_.begin = scan_.end;
    scan_.end += std::chrono::milliseconds(100);
    ++scan_.index;
    odometry.process(scan_, {});
  }

  odometry::OdometryConfig small_;
  StudyOdometry sut_;
};

TEST_F(StudyOdometryInARoom, RegistersFromAPriorWithoutATrace) {
  const inertial::NavState before = sut_.state();
  inertial::NavState prior = before;
  prior.T_odom_imu = geometry::boxplus(prior.T_odom_imu, small_error());

  for (int i = 0; i < 2; ++i) {
    const odometry::UpdateResult result = sut_.registered(scan_, prior, P_);

    EXPECT_LT(geometry::boxminus(result.state.T_odom_imu, before.T_odom_imu).norm(), 0.02);
    EXPECT_EQ(sut_.state().T_odom_imu.translation(), before.T_odom_imu.translation());
  }
}

TEST_F(StudyOdometryInARoom, ForksGoOnForThemselvesWithTheirOwnEstimator) {
  Ekf ekf(small_);
  StudyOdometry fork = sut_;
  fork.use(&ekf, 1);
  inertial::Covariance told = inertial::Covariance::Zero();
  told.diagonal().head<6>().setConstant(1e-3);
  const Eigen::Vector3d before = sut_.state().T_odom_imu.translation();

  fork.disturb(small_error(), told);
  EXPECT_GT((fork.state().T_odom_imu.translation() - before).norm(), 0.03);
  EXPECT_EQ(sut_.state().T_odom_imu.translation(), before);
  advance(fork);

  EXPECT_LT((fork.state().T_odom_imu.translation() - before).norm(), 0.01);
}

}  // namespace
}  // namespace slamd::study
