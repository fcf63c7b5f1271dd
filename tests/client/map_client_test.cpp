#include "client/map_client.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>
#include <random>
#include <string>
#include <thread>

#include "core/occupancy/delta_source.hpp"
#include "daemon/bus/map_encoding.hpp"
#include "daemon/bus/map_request_listener.hpp"
#include "daemon/bus/publisher.hpp"

namespace slamd::client {
namespace {

using occupancy::DeltaKind;
using occupancy::MapDelta;

constexpr std::chrono::milliseconds kAtOnce{0};

occupancy::GridConfig small_grid() {
  occupancy::GridConfig config;
  config.box_m = 9.6;
  config.height_m = 3.2;
  config.max_points = 100;
  return config;
}

/// What a daemon does with scans, on a real LCM of its own: address and port, and no further than this computer, where the
/// prefix tells apart programs that run side by side.
struct MapClientOnTheNetwork : testing::Test {
  static constexpr const char* kUrl = "udpm://239.255.76.68:7994?ttl=0";
  const std::string prefix = "T" + std::to_string(getpid());

  void SetUp() override {
    try {
      connection = std::make_shared<bus::Connection>(kUrl);
    } catch (const bus::BusError& error) {
      GTEST_SKIP() << error.what();
    }
    publisher = std::make_unique<bus::Publisher>(connection, bus::PublisherConfig{.url = kUrl, .prefix = prefix});
    requests = std::make_unique<bus::MapRequestListener>(connection, prefix, [this](const occupancy::MapRequest& request) { source.request(request); });
    source.restart(map_id, 3);
  }

  double any() { return std::uniform_real_distribution<double>(-1.0, 1.0)(engine); }

  void scan(const Eigen::Vector3d& place) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 40; ++i) {
      points.emplace_back((Eigen::Vector3d(4.0 * any(), 4.0 * any(), any()) + place).cast<float>());
    }
    occupancy::CarvingScan scan;
    scan.points_imu = points;
    scan.T_odom_base = geometry::Se3(Eigen::Matrix3d::Identity(), place);
    scan.origin_odom = place;
    grid.insert(scan);
  }

  /// Sends an update, but for one of so many messages.
  void tell(unsigned lost_one_in = 0) {
    while (connection->wait(kAtOnce)) {
    }
    source.begin(Stamp{} + std::chrono::seconds(1));
    MapDelta message;
    DeltaKind kind{};
    while (source.next(message, kind)) {
      if (lost_one_in == 0 || engine() % lost_one_in != 0) {
        publisher->publish(message, kind == DeltaKind::kRepair);
      }
    }
  }

  /// Whether the client has the grid, block by block.
  bool is_same(const MapView& view) const {
    if (!view.complete() || view.cells().window() != grid.states().window()) {
      return false;
    }
    for (std::size_t slot = 0; slot < view.cells().size(); ++slot) {
      if (view.cells().block(slot) != grid.states().block(slot)) {
        return false;
      }
    }
    return true;
  }

  /// Goes on telling until the client has the same map, at most some seconds.
  bool becomes_same(MapClient& client, bool by_hand = false) {
    for (int i = 0; i < 250; ++i) {
      tell();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (by_hand) {
        client.handle();
      }
      if (is_same(*client.view())) {
        return true;
      }
    }
    return false;
  }

  std::mt19937_64 engine{1};
  occupancy::RollingGrid grid{small_grid()};
  occupancy::DeltaSource source{occupancy::DeltaConfig{.key_messages = 0}, grid};
  std::int64_t map_id = 10;
  std::shared_ptr<bus::Connection> connection;
  std::unique_ptr<bus::Publisher> publisher;
  std::unique_ptr<bus::MapRequestListener> requests;
};

TEST_F(MapClientOnTheNetwork, HasTheMapInSpiteOfLosses) {
  MapClient sut({.url = kUrl, .prefix = prefix});
  EXPECT_FALSE(sut.view()->known());
  for (int i = 0; i < 30; ++i) {
    scan({0.3 * i, 0.0, 0.0});
    tell(4);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }

  EXPECT_TRUE(becomes_same(sut));

  EXPECT_EQ(sut.counts().malformed, 0U);
  EXPECT_EQ(sut.counts().differs, 0U);
  std::size_t left = 0;
  sut.take_left([&](const occupancy::Mirror::LeftBlock& block) {
    ++left;
    EXPECT_EQ(block.map_id, map_id);
  });
  EXPECT_GT(left, 0U) << "the window has moved by 9 m";
}

TEST_F(MapClientOnTheNetwork, JoinsLateByAskingAndBeginsAnewWithAnotherMap) {
  for (int i = 0; i < 10; ++i) {
    scan({0.3 * i, 0.0, 0.0});
    tell();
  }
  MapClient sut({.url = kUrl, .prefix = prefix, .own_thread = false});
  EXPECT_GE(sut.fd(), 0);
  EXPECT_TRUE(becomes_same(sut, true));
  EXPECT_GE(sut.counts().requests, 1U);
  const auto before = sut.view();

  grid.restart(Eigen::Vector3d::Zero());
  source.restart(++map_id, 4);
  scan(Eigen::Vector3d::Zero());
  EXPECT_TRUE(becomes_same(sut, true));

  EXPECT_EQ(sut.view()->map_id(), map_id);
  EXPECT_EQ(sut.counts().maps, 2U);
  EXPECT_EQ(before->map_id(), map_id - 1) << "what is being looked at stays as it was";
}

TEST_F(MapClientOnTheNetwork, RecoversFromAForgedMessageOfItsOwnMap) {
  MapClient sut({.url = kUrl, .prefix = prefix, .own_thread = false});
  scan(Eigen::Vector3d::Zero());
  ASSERT_TRUE(becomes_same(sut, true));
  MapDelta forged;
  forged.map_id = map_id;
  forged.covers = {0, 1'000'000'000'000};
  forged.newest = forged.covers.to;
  forged.window = grid.states().window();
  forged.window.first.x += 1000;
  publisher->publish(forged, false);
  for (int i = 0; i < 250 && is_same(*sut.view()); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    sut.handle();
  }
  ASSERT_FALSE(is_same(*sut.view()));

  EXPECT_TRUE(becomes_same(sut, true));
}

TEST_F(MapClientOnTheNetwork, AnswersWhatAPlannerAsksAndFollowsItsSubmaps) {
  source.set_anchor(5, {0, 0, 0});
  grid.set_submap(5);
  MapClient sut({.url = kUrl, .prefix = prefix});
  scan(Eigen::Vector3d::Zero());
  bus::MapToOdom map_to_odom;
  map_to_odom.T_map_odom = geometry::Se3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(100.0, 0.0, 0.0));
  publisher->publish(map_to_odom);
  bus::SubmapPoses poses;
  poses.stamp = Stamp{} + std::chrono::seconds(2);
  poses.epoch = 3;
  poses.size = 1;
  poses.submaps[0] = {5, 2, Eigen::Vector3d::Zero(), geometry::Se3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(200.0, 0.0, 0.0))};
  publisher->publish(poses);
  ASSERT_TRUE(becomes_same(sut));

  const auto view = sut.view();
  const auto obstacle = view->nearest(Eigen::Vector3d::Zero(), 10.0);
  ASSERT_TRUE(obstacle);
  const Eigen::Vector3d p_odom = occupancy::centre_of(obstacle->cell, 0.2);
  EXPECT_EQ(view->at(p_odom), occupancy::CellState::kOccupied);
  EXPECT_TRUE(view->is_current(p_odom));
  EXPECT_GE(view->count(p_odom, p_odom).occupied, 1U);
  EXPECT_TRUE(view->cast(Eigen::Vector3d::Zero(), p_odom, false));
  ASSERT_NE(view->submap(5), nullptr);
  EXPECT_EQ(view->submap(5)->version, 2U);
  EXPECT_NEAR(view->to_map(p_odom).x(), p_odom.x() + 200.0, 1e-9) << "by its submap";
  EXPECT_NEAR(view->to_map({50.0, 0.0, 0.0}).x(), 150.0, 1e-9) << "by odom";

  // The daemon starts again, in the same epoch, with its clock behind.
  source.restart(++map_id, 3);
  ASSERT_TRUE(becomes_same(sut));
  EXPECT_EQ(sut.view()->submap(5), nullptr);
  poses.stamp = Stamp{} + std::chrono::seconds(1);
  poses.submaps[0].version = 1;
  publisher->publish(poses);
  const auto told = [&] { return sut.view()->submap(5) != nullptr; };
  for (int i = 0; i < 250 && !told(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_TRUE(told());
}

TEST_F(MapClientOnTheNetwork, IsNotAnsweredWhenItFloods) {
  const Eigen::Vector3d place = Eigen::Vector3d::Zero();
  scan(place);
  occupancy::MapRequest request;
  request.map_id = map_id;
  request.ranges.push_back({0, 100});
  std::vector<std::byte> bytes(bus::kLargestMessage_bytes);
  bytes.resize(bus::encode(request, bytes));
  bus::MapRequestListener::Clock::time_point now{std::chrono::seconds(1)};

  for (int i = 0; i < 1000; ++i) {
    requests->take(bytes, now);
  }
  requests->take({}, now + std::chrono::seconds(1));

  EXPECT_EQ(requests->counters().accepted, static_cast<std::uint64_t>(bus::MapRequestListener::kBurst));
  EXPECT_EQ(requests->counters().limited, 1000U - bus::MapRequestListener::kBurst);
  EXPECT_EQ(requests->counters().malformed, 1U);
}

}  // namespace
}  // namespace slamd::client
