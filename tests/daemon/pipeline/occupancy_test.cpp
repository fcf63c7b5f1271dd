#include "daemon/pipeline/occupancy_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <malloc.h>

#include "core/occupancy/mirror.hpp"
#include "core/occupancy/queries.hpp"
#include "daemon/bus/map_encoding.hpp"
#include "daemon/pipeline/pipeline.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::pipeline {
namespace {

using occupancy::CellState;
using occupancy::Mirror;

odometry::OdometryConfig odometry_of_few_points() {
  odometry::OdometryConfig config;
  config.preprocess.max_points = 1'000;
  config.preprocess.max_map_points = 100;
  config.use_imu = false;
  return config;
}

Duration monotonic_now{};

double bytes_planned(const configuration::Configuration& configuration) {
  double sum = 0.0;
  for (const MemoryItem& item : memory_plan(configuration)) {
    sum += static_cast<double>(item.count) * static_cast<double>(item.item_bytes);
  }
  return sum;
}

/// The publish and occupancy loops without their threads, and a client's copy of what they send.
struct Occupancy : testing::Test {
  Occupancy() {
    const auto take = [this](std::span<const std::byte> message) {
      const auto delta = bus::decode_map_delta(message);
      ASSERT_TRUE(delta);
      newest = *delta;
      mirror.apply(*delta);
    };
    connection->subscribe("SLAMD_MAP_DELTA", take);
    connection->subscribe("SLAMD_MAP_SNAPSHOT", take);
    publish.feed_occupancy(Eigen::Vector3d(0.0, 0.0, 0.5));
    grid.box_m = 20.0;
    grid.height_m = 3.2;
  }

  /// A scan through publish: a wall 3 m ahead of a robot at x.
  void publish_scan(double x, std::uint32_t epoch = 1, bool trusted = true) { publish_scan(publish, x, epoch, trusted); }

  void publish_scan(PublishLoop& loop, double x, std::uint32_t epoch = 1, bool trusted = true) {
    auto job = rings.job_pool.acquire();
    ASSERT_TRUE(job);
    job->processed = true;
    job->scan.without_scan = false;
    job->scan.epoch = epoch;
    job->anchor.epoch = epoch;
    job->result.map_updated = trusted;
    job->result.stamp = Stamp{} + ++scans * std::chrono::milliseconds(100);
    job->result.T_odom_base = job->result.T_odom_imu = geometry::Se3(Eigen::Matrix3d::Identity(), {x, 0.0, 0.0});
    job->scan.deskewed.begin = job->scan.deskewed.end = job->result.stamp;
    job->scan.deskewed.map_points_imu.clear();
    for (float y = -0.9F; y < 1.0F; y += 0.2F) {
      job->scan.deskewed.map_points_imu.push_back({3.1F, y, 0.5F});
    }
    ASSERT_TRUE(rings.to_publish.try_push(std::move(job)));
    loop.run_once(Duration{});
  }

  void hear() {
    while (connection->wait(std::chrono::milliseconds(0))) {
    }
  }

  CellState at(double x) const { return occupancy::state_at(mirror.map(), {x, 0.1, 0.5}); }

  transport::HostClock clock{[] { return transport::ClockReadings{monotonic_now, monotonic_now + std::chrono::hours(1)}; }};
  odometry::OdometryConfig odometry = odometry_of_few_points();
  Rings rings{odometry, 8, 64};
  std::shared_ptr<bus::Connection> connection = std::make_shared<bus::Connection>("memq://");
  bus::Publisher publisher{connection, {}};
  PublishLoop publish{odometry, std::chrono::milliseconds(100), clock, rings, publisher, false};
  occupancy::GridConfig grid;
  Mirror mirror;
  std::optional<occupancy::MapDelta> newest;
  int scans = 0;
};

TEST_F(Occupancy, TellsAClientWhatTheScansShow) {
  OccupancyLoop sut(grid, clock, rings, publisher);
  publish_scan(0.0);
  sut.run_once(Duration{});
  hear();

  EXPECT_TRUE(mirror.complete());
  EXPECT_EQ(at(3.1), CellState::kOccupied);
  EXPECT_EQ(at(1.5), CellState::kFree);
  EXPECT_EQ(at(4.1), CellState::kUnknown);
  EXPECT_EQ(newest->stamp, Stamp{} + std::chrono::milliseconds(100));
  EXPECT_EQ(newest->epoch, 1U);
  EXPECT_EQ(sut.counts().scans, 1U);
  EXPECT_GE(sut.counts().changes, 1U);
}

TEST_F(Occupancy, LetsWhatItCannotTakeGoAndNeverWaits) {
  OccupancyLoop sut(grid, clock, rings, publisher);
  for (int i = 0; i < 10; ++i) {
    publish_scan(0.0);
  }
  EXPECT_EQ(publish.counts().scans_uncarved, 10U - Rings::kCarveScans);

  for (int i = 0; i < 10; ++i) {
    sut.run_once(Duration{});
  }
  publish_scan(0.0);

  EXPECT_EQ(sut.counts().scans, Rings::kCarveScans);
  EXPECT_EQ(publish.counts().scans_uncarved, 10U - Rings::kCarveScans) << "all are free again";
}

TEST_F(Occupancy, ChangesNothingByAScanWhosePoseIsNotTrusted) {
  OccupancyLoop sut(grid, clock, rings, publisher);
  publish_scan(0.0, 1, false);
  sut.run_once(Duration{});
  hear();

  EXPECT_TRUE(mirror.complete());
  EXPECT_EQ(at(3.1), CellState::kUnknown);
}

TEST_F(Occupancy, BeginsAnotherMapWithAnotherOdom) {
  OccupancyLoop sut(grid, clock, rings, publisher);
  publish_scan(0.0);
  sut.run_once(Duration{});
  hear();
  const std::int64_t map_id = mirror.map_id();

  publish_scan(2.0, 2);
  sut.run_once(Duration{});
  hear();

  EXPECT_GT(mirror.map_id(), map_id);
  EXPECT_EQ(mirror.epoch(), 2U);
  EXPECT_EQ(at(3.1), CellState::kFree) << "the robot stands at 2 m now";
  EXPECT_EQ(at(5.1), CellState::kOccupied);
}

TEST_F(Occupancy, SaysWhichSubmapIsTheNewestAndAnswersRequests) {
  OccupancyLoop sut(grid, clock, rings, publisher);
  rings.newest_submap.store(stages::NewestSubmap::of(4, {1.6, -3.2, 0.0}, 1));
  publish_scan(0.0);
  sut.run_once(Duration{});
  hear();
  mirror.forget();
  newest.reset();
  publish_scan(0.0);
  sut.run_once(Duration{});
  hear();
  ASSERT_TRUE(newest);
  occupancy::MapRequest request;
  request.map_id = newest->map_id;
  request.ranges.push_back({0, newest->newest});
  rings.map_requests.try_push(request);

  publish_scan(0.0);
  sut.run_once(Duration{});
  hear();

  EXPECT_TRUE(mirror.complete());
  EXPECT_GE(sut.counts().repairs, 1U);
  const occupancy::BlockIndex wall = occupancy::cell_of({3.1, 0.1, 0.5}, 0.2).block();
  EXPECT_EQ(mirror.submap(mirror.map().window().slot_of(wall)), 4);
  EXPECT_EQ(stages::NewestSubmap::of(4, {1.6, -3.2, 0.0}, 1).anchor_odom_m[1], -3.2);
}

TEST_F(Occupancy, TellsFiveTimesASecondWhereNoScanComes) {
  OccupancyLoop sut(grid, clock, rings, publisher);
  const auto tells = [&](int after_ms) {
    monotonic_now += std::chrono::milliseconds(after_ms);
    const std::uint64_t before = sut.counts().changes;
    sut.run_once(Duration{});
    return sut.counts().changes > before;
  };
  EXPECT_FALSE(tells(1000)) << "there is no map yet";
  publish_scan(0.0);
  EXPECT_TRUE(tells(0));

  EXPECT_FALSE(tells(199));
  EXPECT_TRUE(tells(1));
  EXPECT_FALSE(tells(100));
  EXPECT_TRUE(tells(100));
}

// LCM's memq allocates, udpm does not: so scans with and without, and the fewest, for GLib takes pages now and then.
TEST_F(Occupancy, IsHandedScansWithoutAllocating) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  PublishLoop without(odometry, std::chrono::milliseconds(100), clock, rings, publisher, false);
  const auto fewest_allocations = [this](PublishLoop& loop) {
    std::size_t fewest = ~std::size_t{0};
    for (int i = 0; i < 8; ++i) {
      fewest = std::min(fewest, support::count_allocations([&] { publish_scan(loop, 0.0); }));
      hear();
      rings.to_occupancy.try_pop();
    }
    return fewest;
  };

  const std::size_t expected = fewest_allocations(without);

  EXPECT_EQ(fewest_allocations(publish), expected);
  EXPECT_EQ(publish.counts().scans_uncarved, 0U);
}

TEST_F(Occupancy, TakesTheMemoryThatIsPlanned) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  configuration::Configuration on;
  on.occupancy.use = true;
  configuration::Configuration off = on;
  off.occupancy.use = false;
  const auto used = [] {
    const auto info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
  };

  const double before = used();
  const OccupancyLoop sut(stages::grid_config(on), clock, rings, publisher);
  const double taken = used() - before;
  const double planned = bytes_planned(on) - bytes_planned(off) - static_cast<double>(threads::RealTimeThread::kStackBytes);

  EXPECT_GT(planned, 1e6);
  EXPECT_LE(std::abs(taken - planned), 0.01 * planned) << "taken " << taken << ", planned " << planned;
}

}  // namespace
}  // namespace slamd::pipeline
