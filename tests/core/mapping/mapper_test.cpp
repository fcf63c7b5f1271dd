#include "core/mapping/mapper.hpp"

#include <gtest/gtest.h>

#include "tests/circles/circles.hpp"

namespace slamd::mapping {
namespace {

using geometry::Se3;

using circles::Circles;
using circles::small;

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

TEST(Mapper, FindsAPlaceAgainByItsLooksWhereItDoesNotKnowAnyMoreWhereItIs) {
  const auto largest_error_m = [](bool use_loop_net) {
    Circles drive;
    mapping::MapperConfig config = small();
    config.use_loop_net = use_loop_net;
    Mapper sut(config);
    for (int i = 0; i < 100; ++i) {
      sut.process(drive.step());
    }
    drive.lose_the_way({9.0, -7.0, 0.0}, 12.0);
    for (int i = 0; i < 150; ++i) {
      sut.process(drive.step());
    }
    return drive.error_m(sut.T_map_odom() * drive.T_odom_base());
  };

  EXPECT_LT(largest_error_m(true), 0.3);
  EXPECT_GT(largest_error_m(false), 5.0);
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
