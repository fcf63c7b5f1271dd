#include "tools/status/listener.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "daemon/bus/encoding.hpp"
#include "daemon/bus/publisher.hpp"
#include "tests/daemon/bus/made_messages.hpp"

namespace slamd::status {
namespace {

using std::chrono::milliseconds;

TEST(Listener, CollectsWhatADaemonSends) {
  const auto connection = std::make_shared<bus::Connection>("memq://");
  bus::Publisher daemon(connection, {.prefix = "ROBOT2"});
  Listener sut(*connection, "ROBOT2");
  const std::vector<Eigen::Vector3f> points(500, Eigen::Vector3f::Ones());
  bus::Scan scan;
  scan.points_imu = points;

  daemon.publish(bus::made_pose());
  daemon.publish(bus::made_pose());
  daemon.publish(bus::MapToOdom{});
  daemon.publish(scan);
  daemon.publish(bus::full_health());
  sut.listen_until(Clock::now() + milliseconds(50));

  const Heard& heard = sut.heard();
  EXPECT_TRUE(heard.anything());
  EXPECT_EQ(heard.pose.count, 2U);
  EXPECT_EQ(heard.map_to_odom.count, 1U);
  EXPECT_EQ(heard.health.count, 1U);
  EXPECT_EQ(heard.scans, 1U);
  EXPECT_EQ(heard.malformed, 0U);
}

TEST(Listener, CountsWhatItDoesNotUnderstand) {
  bus::Connection connection("memq://");
  Listener sut(connection, "SLAMD");
  const std::vector<std::byte> garbage(100, std::byte{1});

  connection.send("SLAMD_POSE", garbage);
  connection.send("SLAMD_SCAN", garbage);
  connection.send("SLAMD_HEALTH", garbage);
  sut.listen_until(Clock::now() + milliseconds(50));

  EXPECT_EQ(sut.heard().malformed, 3U);
  EXPECT_FALSE(sut.heard().anything());
}

TEST(Listener, HandsOnTheTruthOfItsPrefix) {
  bus::Connection connection("memq://");
  Listener sut(connection, "ROBOT2");
  std::vector<bus::Truth> heard;
  sut.on_truth([&](const bus::Truth& truth) { heard.push_back(truth); });
  bus::Truth truth;
  truth.T_world_base.translation() = {1.0, 2.0, 3.0};
  std::array<std::byte, bus::kLargestMessage_bytes> buffer;
  const std::span<const std::byte> message(buffer.data(), bus::encode(truth, buffer));

  connection.send("ROBOT2_TRUTH", message);
  connection.send("SLAMD_TRUTH", message);
  connection.send("ROBOT2_TRUTH", message.first(10));
  sut.listen_until(Clock::now() + milliseconds(50));

  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].T_world_base.translation(), truth.T_world_base.translation());
  EXPECT_EQ(sut.heard().malformed, 1U);
}

TEST(Listener, StopsWaitingAsSoonAsThereIsHealth) {
  const auto connection = std::make_shared<bus::Connection>("memq://");
  bus::Publisher daemon(connection, {});
  Listener sut(*connection, "SLAMD");
  daemon.publish(bus::made_pose());
  daemon.publish(bus::full_health());
  const auto begin = Clock::now();

  sut.listen_for_health(begin + std::chrono::seconds(20));

  EXPECT_TRUE(sut.heard().health.message);
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10));
}

TEST(ExitCode, TellsTrackingFromAnotherStateFromSilence) {
  Heard heard;
  EXPECT_EQ(exit_code_of(heard), 1);

  heard.health.message = bus::Health{};
  heard.health.message->state = bus::State::kTracking;
  EXPECT_EQ(exit_code_of(heard), 0);

  for (const bus::State state :
       {bus::State::kStarting, bus::State::kDegraded, bus::State::kLost, bus::State::kRelocalising}) {
    heard.health.message->state = state;
    EXPECT_EQ(exit_code_of(heard), 3);
  }
}

}  // namespace
}  // namespace slamd::status
