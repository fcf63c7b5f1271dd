#include "daemon/pipeline/mapping_loop.hpp"

#include <gtest/gtest.h>

#include "daemon/bus/encoding.hpp"
#include "daemon/pipeline/publish_loop.hpp"
#include "drivers/storage/session_reader.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::pipeline {
namespace {

using geometry::Se3;

Se3 at(double x, double yaw_rad) { return {geometry::rotation_from_rpy({0.0, 0.0, yaw_rad}), {x, 0.0, 0.0}}; }

odometry::OdometryConfig small_odometry() {
  odometry::OdometryConfig config;
  config.preprocess.max_points = 1'000;
  config.preprocess.max_map_points = 100;
  return config;
}

mapping::MapperConfig small_mapper() {
  mapping::MapperConfig config;
  config.keyframes = 100;
  config.loops = 16;
  config.points_a_cloud = 500;
  config.back_end.factor_entries = 10'000;
  return config;
}

/// The mapping and publish loops without their threads, and what they send.
struct Mapping : scratch::ScratchFolder {
  Mapping() {
    connection->subscribe("SLAMD_MAP_TO_ODOM", [this](auto bytes) { map_to_odom = bus::decode_map_to_odom(bytes); });
    connection->subscribe("SLAMD_SUBMAP_POSES", [this](auto bytes) { submap_poses = bus::decode_submap_poses(bytes); });
  }

  /// A scan of a drive along x, as publish hands it over.
  void hand_over(int number, std::uint32_t epoch = 1) {
    MapScan scan;
    scan.scan.epoch = epoch;
    scan.scan.stamp = Stamp{} + number * std::chrono::milliseconds(100);
    scan.scan.trusted = true;
    scan.scan.T_odom_base = scan.scan.T_odom_imu = scan.scan.motion.T_odom_base = at(0.5 * number, 0.0);
    scan.points = rings.points_pool.acquire();
    if (scan.points) {
      scan.points->assign(std::vector<Eigen::Vector3f>(50, Eigen::Vector3f::Ones()));
    }
    ASSERT_TRUE(rings.to_mapping.try_push(std::move(scan)));
  }

  void hear() {
    while (connection->wait(std::chrono::milliseconds(0))) {
    }
  }

  transport::HostClock clock;
  odometry::OdometryConfig odometry = small_odometry();
  Rings rings{odometry, 8, 64};
  std::shared_ptr<bus::Connection> connection = std::make_shared<bus::Connection>("memq://");
  bus::Publisher publisher{connection, {}};
  std::optional<bus::MapToOdom> map_to_odom;
  std::optional<bus::SubmapPoses> submap_poses;
};

TEST_F(Mapping, SaysWhereSubmapsLieAndGivesEachCloudBack) {
  MappingLoop sut(small_mapper(), {}, clock, rings, publisher);
  rings.placement.store(MapPlacement{.x_m = 100.0, .correction_id = 2, .cause = bus::Correction::kCommand});

  for (int i = 0; i < 60; ++i) {
    hand_over(i);
    sut.run_once(Duration{});
  }
  rings.placement.store(MapPlacement{.x_m = 200.0, .correction_id = 3, .cause = bus::Correction::kCommand});
  sut.run_once(Duration{});
  hear();

  EXPECT_EQ(sut.counts().scans, 60U);
  EXPECT_GE(sut.counts().keyframes, 10U);
  EXPECT_EQ(rings.points_pool.exhausted(), 0U);
  ASSERT_TRUE(submap_poses);
  EXPECT_EQ(submap_poses->correction_id, 3U);
  EXPECT_EQ(submap_poses->epoch, 1U);
  ASSERT_EQ(submap_poses->size, 2U) << "30 m of way";
  const bus::SubmapPose& second = submap_poses->submaps[1];
  EXPECT_TRUE(second.T_map_submap.translation().isApprox(second.anchor_odom + Eigen::Vector3d(200.0, 0.0, 0.0), 1e-9));
}

TEST_F(Mapping, BeginsAnewWithAnotherEpoch) {
  MappingLoop sut(small_mapper(), {}, clock, rings, publisher);
  for (int i = 0; i < 60; ++i) {
    hand_over(i);
    sut.run_once(Duration{});
  }
  MapScan scan;
  scan.scan.epoch = 2;
  ASSERT_TRUE(rings.to_mapping.try_push(std::move(scan)));

  sut.run_once(Duration{});

  EXPECT_EQ(sut.counts().keyframes, 0U);
}

TEST_F(Mapping, KeepsEachMapAsASession) {
  storage::SessionKeeping keeping;
  keeping.folder = folder_;
  MappingLoop sut(small_mapper(), keeping, clock, rings, publisher);
  for (int i = 0; i < 60; ++i) {
    hand_over(i);
    sut.run_once(Duration{});
  }
  const auto first = storage::read_session(std::filesystem::directory_iterator(folder_)->path());  // as if it were killed now
  EXPECT_EQ(first.keyframes.size(), sut.counts().keyframes);
  EXPECT_FALSE(first.closed);
  MapScan scan;
  scan.scan.epoch = 2;
  scan.scan.trusted = true;
  ASSERT_TRUE(rings.to_mapping.try_push(std::move(scan)));

  sut.run_once(Duration{});
  sut.finish();

  std::size_t closed = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    closed += storage::read_session(entry.path()).closed ? 1 : 0;
  }
  EXPECT_EQ(closed, 2U);
}

TEST_F(Mapping, WritesTheCorrectedMapWhenAsked) {
  MappingLoop sut(small_mapper(), {}, clock, rings, publisher);
  for (int i = 0; i < 60; ++i) {
    hand_over(i);
    sut.run_once(Duration{});
  }
  EXPECT_FALSE(sut.corrected_map().take());

  sut.corrected_map().want({folder_ / "map.ply", at(100.0, 0.0), 1});
  sut.run_once(Duration{});

  const auto map = sut.corrected_map().take();
  ASSERT_TRUE(map);
  EXPECT_EQ(map->fault, "");
  EXPECT_EQ(map->path.size(), sut.counts().keyframes);
  EXPECT_GE(map->points, sut.counts().keyframes);
  EXPECT_FALSE(sut.corrected_map().take()) << "once";
}

TEST_F(Mapping, WritesNoMapButTheOneThatIsWanted) {
  MappingLoop sut(small_mapper(), {}, clock, rings, publisher);
  hand_over(0);
  sut.run_once(Duration{});

  sut.corrected_map().want({folder_ / "map.ply", Se3(), 2});
  sut.run_once(Duration{});
  EXPECT_FALSE(sut.corrected_map().take()) << "it has yet to come to that odom";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "map.ply"));
  hand_over(1, 2);
  sut.run_once(Duration{});

  const auto map = sut.corrected_map().take();
  ASSERT_TRUE(map);
  EXPECT_EQ(map->epoch, 2U);
  hand_over(2, 3);
  sut.run_once(Duration{});
  sut.corrected_map().want({folder_ / "map.ply", Se3(), 2});
  sut.run_once(Duration{});
  const auto late = sut.corrected_map().take();
  ASSERT_TRUE(late) << "it will never come again";
  EXPECT_EQ(late->epoch, 3U);
}

TEST_F(Mapping, SaysThatTheSessionIsWrittenAgainOnlyWhenItIs) {
  storage::SessionKeeping keeping;
  keeping.folder = write("sessions", "a file in the folder's place");
  MappingLoop sut(small_mapper(), keeping, clock, rings, publisher);
  const auto events = [&sut] {
    std::vector<threads::Event> all;
    while (const auto record = sut.events().try_read()) {
      all.push_back(record->event);
    }
    return all;
  };
  for (int i = 0; i < 60; ++i) {
    hand_over(i);
    sut.run_once(Duration{});
  }
  EXPECT_EQ(events(), std::vector<threads::Event>{threads::Event::kSessionFault});

  hand_over(60, 2);  // new-map
  sut.run_once(Duration{});
  EXPECT_EQ(sut.counts().keyframes, 0U);
  EXPECT_EQ(events(), std::vector<threads::Event>{});
  std::filesystem::remove(keeping.folder);
  for (int i = 61; i < 120; ++i) {
    hand_over(i, 2);
    sut.run_once(Duration{});
  }

  EXPECT_EQ(events(), (std::vector<threads::Event>{threads::Event::kSessionGoesOn, threads::Event::kSessionBegun}));
}

TEST_F(Mapping, PutsOdomWhereACommandAndMappingHaveIt) {
  PublishLoop sut(odometry, std::chrono::milliseconds(100), clock, rings, publisher, true);
  rings.placement.store(MapPlacement{.x_m = 1.0, .yaw_rad = M_PI_2, .correction_id = 2, .cause = bus::Correction::kCommand});
  sut.run_once(Duration{});
  hear();
  ASSERT_TRUE(map_to_odom);
  EXPECT_EQ(map_to_odom->cause, bus::Correction::kCommand);
  EXPECT_EQ(map_to_odom->correction_id, 2U);

  rings.correction.store(MapCorrection::of(at(3.0, 0.0), 4, sut.counts().epoch));
  sut.run_once(Duration{});
  hear();

  EXPECT_EQ(map_to_odom->cause, bus::Correction::kLoop);
  EXPECT_EQ(map_to_odom->correction_id, 6U);
  EXPECT_TRUE(map_to_odom->T_map_odom.translation().isApprox(Eigen::Vector3d(1.0, 3.0, 0.0), 1e-9));

  rings.correction.store(MapCorrection::of(at(3.0, 0.0), 4, sut.counts().epoch + 1));
  sut.run_once(Duration{});
  hear();

  EXPECT_TRUE(map_to_odom->T_map_odom.translation().isApprox(Eigen::Vector3d(1.0, 0.0, 0.0), 1e-9)) << "it is of another odom";
}

}  // namespace
}  // namespace slamd::pipeline
