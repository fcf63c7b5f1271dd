#include "daemon/bus/publisher.hpp"

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "daemon/bus/encoding.hpp"
#include "tests/daemon/bus/made_messages.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::bus {
namespace {

constexpr std::chrono::milliseconds kAtOnce{0};

Scan made_scan(std::span<const Eigen::Vector3f> points_imu) {
  Scan scan;
  scan.points_imu = points_imu;
  return scan;
}

TEST(Publisher, SendsEachMessageOnItsChannel) {
  const auto connection = std::make_shared<Connection>("memq://");
  Publisher sut(connection, {.prefix = "ROBOT-2"});
  std::vector<std::string> heard;
  connection->subscribe("ROBOT-2_POSE", [&](auto bytes) { heard.push_back(decode_pose(bytes) ? "pose" : "?"); });
  connection->subscribe("ROBOT-2_MAP_TO_ODOM", [&](auto bytes) { heard.push_back(decode_map_to_odom(bytes) ? "map" : "?"); });
  connection->subscribe("ROBOT-2_SCAN", [&](auto bytes) { heard.push_back(decode_scan_chunk(bytes) ? "scan" : "?"); });
  connection->subscribe("ROBOT-2_HEALTH", [&](auto bytes) { heard.push_back(decode_health(bytes) ? "health" : "?"); });
  const std::vector<Eigen::Vector3f> points(201, Eigen::Vector3f::Ones());

  const bool all = sut.publish(made_pose()) && sut.publish(MapToOdom{}) && sut.publish(made_scan(points)) &&
                   sut.publish(full_health());
  while (connection->wait(kAtOnce)) {
  }

  EXPECT_TRUE(all);
  EXPECT_EQ(heard, (std::vector<std::string>{"pose", "map", "scan", "scan", "health"}));
  EXPECT_EQ(sut.messages_sent(), 5U);
  EXPECT_EQ(sut.messages_failed(), 0U);
}

TEST(Publisher, SendsNoScanWhenSwitchedOff) {
  const auto connection = std::make_shared<Connection>("memq://");
  Publisher sut(connection, {.scan_points = 0});
  const std::vector<Eigen::Vector3f> points(10, Eigen::Vector3f::Ones());

  EXPECT_TRUE(sut.publish(made_scan(points)));

  EXPECT_EQ(sut.messages_sent(), 0U);
}

TEST(Publisher, RefusesAPrefixThatIsNone) {
  for (const std::string prefix : {"", "A B", "A.*", "a2345678901234567890123456789012345678901"}) {
    EXPECT_THROW(Publisher(PublisherConfig{.url = "memq://", .prefix = prefix}), std::invalid_argument) << prefix;
  }
}

TEST(Publisher, SaysWhatIsWrongWithAUrlThatLeadsNowhere) {
  try {
    Publisher sut({.url = "pigeon://roof"});
    FAIL();
  } catch (const BusError& error) {
    EXPECT_NE(std::string(error.what()).find("pigeon://roof"), std::string::npos);
  }
}

TEST(Connection, SaysThatItCannotListen) {
  if (!support::allocation_guard_available()) {
    GTEST_SKIP() << "a sanitizer sees the two bytes that LCM itself loses when it refuses";
  }
  Connection sut("memq://");

  EXPECT_THROW(sut.subscribe("(", [](auto) {}), BusError) << "for LCM a channel is a regular expression";
}

TEST(Publisher, MaySendEachKindFromAThreadOfItsOwn) {
  const auto connection = std::make_shared<Connection>("memq://");
  Publisher sut(connection, {});
  const std::vector<Eigen::Vector3f> points(150, Eigen::Vector3f::Ones());
  const auto repeat = [&sut](const auto& message) {
    for (int i = 0; i < 200; ++i) {
      sut.publish(message);
    }
  };
  // GLib makes LCM's lock at the first message, by an atomic exchange inside a library ThreadSanitizer cannot see into.
  connection->send("WARM_UP", {});

  std::thread poses([&] { repeat(made_pose()); });
  std::thread scans([&] { repeat(made_scan(points)); });
  std::thread healths([&] { repeat(full_health()); });
  repeat(MapToOdom{});
  poses.join();
  scans.join();
  healths.join();

  EXPECT_EQ(sut.messages_sent(), 800U);
}

TEST(Publisher, DoesNotAllocateOnTheNetwork) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::unique_ptr<Publisher> sut;
  try {
    // An address and a port of its own, and no further than this computer.
    sut = std::make_unique<Publisher>(PublisherConfig{.url = "udpm://239.255.76.68:7991?ttl=0"});
  } catch (const BusError& error) {
    GTEST_SKIP() << error.what();
  }
  const std::vector<Eigen::Vector3f> points(5000, Eigen::Vector3f::Ones());
  const Scan scan = made_scan(points);
  sut->publish(made_pose());  // the first makes LCM test itself

  const std::size_t count = support::count_allocations([&] {
    for (int i = 0; i < 100; ++i) {
      sut->publish(made_pose());
      sut->publish(MapToOdom{});
      sut->publish(scan);
    }
  });

  EXPECT_EQ(count, 0U);
  EXPECT_EQ(sut->messages_failed(), 0U);
}

}  // namespace
}  // namespace slamd::bus
