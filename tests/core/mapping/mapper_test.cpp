#include "core/mapping/mapper.hpp"

#include <gtest/gtest.h>

#include "core/geometry/so3.hpp"
#include "tests/world/room.hpp"

namespace slamd::mapping {
namespace {

using geometry::Se3;

constexpr double kStep_m = 0.2;
constexpr double kRadius_m = 3.0;
constexpr double kDrift_rad = 0.0015;  // a step, to one side

MapperConfig small() {
  MapperConfig config;
  config.keyframes = 120;
  config.use_gravity = false;
  config.loops = 64;
  config.points_a_cloud = 2'000;
  config.scans_a_cloud = 3;
  config.submap_m = 6.0;
  config.quiet_m = 2.0;
  config.novelty.recent_m = config.proximity.recent_m = config.proximity.apart_m = 10.0;
  config.neighbours_m = 3.0;
  config.back_end.factor_entries = 200'000;
  return config;
}

/// A drive in circles through a hall, by an odometry that turns a little too far at each step and says so.
class Circles {
 public:
  Circles() { step(); }

  Se3 T_true() const {
    const double angle = kStep_m * steps_ / kRadius_m;
    return {geometry::rotation_from_rpy({0.0, 0.0, angle + M_PI_2}), {kRadius_m * std::cos(angle), kRadius_m * std::sin(angle) + 0.5, 1.0}};
  }

  /// Drives on by one scan.
  MappedScan step() {
    const Se3 before = T_true();
    ++steps_;
    const Se3 wrong_turn(geometry::so3_exp({0.0, 0.0, kDrift_rad}), Eigen::Vector3d::Zero());
    T_odom_base_ = T_odom_base_ * (before.inverse() * T_true()) * wrong_turn;
    motion_.T_odom_base = T_odom_base_;
    motion_.drift_base.setZero();
    motion_.drift_base.diagonal() << 1e-6, 1e-6, 1e-6, 1e-8, 1e-8, 4e-5;
    points_ = room_.points_lidar(T_true(), 150, 0.01, engine_);
    MappedScan scan;
    scan.stamp = Stamp{} + steps_ * std::chrono::milliseconds(100);
    scan.T_odom_base = scan.T_odom_imu = T_odom_base_;
    scan.indoor = scan.trusted = true;
    scan.motion = &motion_;
    scan.points_imu = points_;
    return scan;
  }

  /// How far a pose of the newest scan is off, map being where it is at the first scan.
  double error_m(const Se3& T_map_base) const {
    return ((T_first_.inverse() * T_true()).translation() - T_map_base.translation()).norm();
  }

  const Se3& T_odom_base() const { return T_odom_base_; }

 private:
  world::Room room_;
  std::mt19937_64 engine_{5};
  int steps_ = 0;
  Se3 T_first_ = T_true();
  Se3 T_odom_base_;
  odometry::MotionStep motion_;
  std::vector<Eigen::Vector3f> points_;
};

TEST(Mapper, CorrectsTheMapWhereTheWayComesBack) {
  Circles drive;
  Mapper sut(small());
  std::uint32_t corrections = 0;

  for (int i = 0; i < 240; ++i) {
    corrections += sut.process(drive.step()).corrected ? 1 : 0;
  }

  const double odometry_m = drive.error_m(drive.T_odom_base());
  const double map_m = drive.error_m(sut.T_map_odom() * drive.T_odom_base());
  EXPECT_GT(odometry_m, 0.5);
  EXPECT_LT(map_m, 0.2 * odometry_m);
  EXPECT_GE(sut.counts().accepted(), 3U);
  EXPECT_EQ(sut.counts().removed(), 0U);
  EXPECT_EQ(sut.correction_id(), corrections);
  EXPECT_GT(sut.submaps()[1].version, 0U);
}

TEST(Mapper, TakesFewerKeyframesOnGroundThatItKnows) {
  Circles drive;
  Mapper sut(small());
  std::vector<std::size_t> at_each_lap;

  for (int lap = 0; lap < 4; ++lap) {
    for (int i = 0; i < 94; ++i) {
      sut.process(drive.step());
    }
    at_each_lap.push_back(sut.keyframes().size());
  }

  EXPECT_LT(at_each_lap[3] - at_each_lap[2], at_each_lap[0] / 2);
}

TEST(Mapper, GivesTheSameMapForTheSameDrive) {
  Circles drive_a;
  Circles drive_b;
  Mapper a(small());
  Mapper b(small());

  for (int i = 0; i < 150; ++i) {
    a.process(drive_a.step());
    b.process(drive_b.step());
  }

  ASSERT_EQ(a.keyframes().size(), b.keyframes().size());
  for (std::size_t i = 0; i < a.keyframes().size(); ++i) {
    EXPECT_EQ(a.T_map_base(i).translation(), b.T_map_base(i).translation());
  }
}

TEST(Mapper, TakesNoKeyframeFromScansThatTheOdometryDoesNotTrust) {
  Circles drive;
  Mapper sut(small());

  for (int i = 0; i < 30; ++i) {
    MappedScan scan = drive.step();
    scan.trusted = false;
    sut.process(scan);
  }
  sut.finish();

  EXPECT_TRUE(sut.keyframes().empty());
}

TEST(Mapper, RetiresTheMostRedundantKeyframeAtTheLimitAndGoesOn) {
  Circles drive;
  MapperConfig config = small();
  config.keyframes = 20;
  config.kept_at_limit = 8;
  Mapper sut(config);

  for (int i = 0; i < 240; ++i) {
    sut.process(drive.step());
  }

  EXPECT_LE(sut.keyframes().size(), 20U);
  EXPECT_GT(sut.retired(), 0U);
  EXPECT_EQ(sut.keyframes()[0].id, 0U);
  EXPECT_EQ(sut.graph().size(), sut.keyframes().size());
  for (std::size_t i = 0; i < sut.graph().size(); ++i) {
    EXPECT_EQ(sut.graph().node(i).id, sut.keyframes()[i].id);
  }
  EXPECT_LT(drive.error_m(sut.T_map_odom() * drive.T_odom_base()), 0.5 * drive.error_m(drive.T_odom_base()));
}

TEST(Mapper, BeginsAnewWithAnotherOdom) {
  Circles drive;
  Mapper sut(small());
  for (int i = 0; i < 200; ++i) {
    sut.process(drive.step());
  }
  const std::uint32_t corrections = sut.correction_id();

  sut.restart();
  Circles again;
  for (int i = 0; i < 20; ++i) {
    sut.process(again.step());
  }

  EXPECT_GT(corrections, 0U);
  EXPECT_EQ(sut.correction_id(), corrections + 1);
  EXPECT_LE(sut.keyframes().size(), 6U);
  EXPECT_TRUE(sut.T_map_odom().translation().isZero());
}

}  // namespace
}  // namespace slamd::mapping
