#include "daemon/devices/livox_device.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <poll.h>

#include "drivers/livox/sdk1_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::devices {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::uint32_t kLoopback = 0x7F000001;

configuration::Configuration avia(int command_port) {
  configuration::Configuration configuration;
  configuration.lidar.model = configuration::LidarModel::kLivoxAvia;
  configuration.lidar.device.code = "3JEDK380010Z391";
  configuration.lidar.device.command_port = command_port;
  return configuration;
}

/// A port that is free now.
int free_port() { return transport::DatagramSocket(0).port(); }

bool wait_for(int fd) {
  pollfd waited{fd, POLLIN, 0};
  return poll(&waited, 1, 1000) == 1;
}

TEST(LivoxDevice, AnswersABroadcastFromItsCommandPortAndSaysSo) {
  LivoxDevice sut(avia(free_port()));
  transport::DatagramSocket device(0);
  std::vector<std::string> said;
  const auto say = [&](const std::string&, const std::string& sentence) { said.push_back(sentence); };
  EXPECT_EQ(sut.cause(), "searching");
  const auto broadcast = livox::write_sdk1_frame(
      {livox::Sdk1FrameType::kMessage, 0, livox::Sdk1Command::kBroadcast,
       livox::Sdk1Broadcast{livox::DeviceCode::of("3JEDK380010Z391"), 7, 0}.bytes().view()});

  ASSERT_TRUE(device.send(broadcast.view(), kLoopback, 55000));
  ASSERT_TRUE(wait_for(sut.fds().front()));
  sut.run_once(Stamp{std::chrono::seconds{1000}}, {}, say);

  ASSERT_TRUE(wait_for(device.fd()));
  const auto received = device.receive();
  ASSERT_TRUE(received);
  livox::Sdk1Frame frame;
  std::size_t size = 0;
  ASSERT_EQ(parse_sdk1_frame(received->payload, frame, size), livox::FrameResult::kOk);
  EXPECT_EQ(frame.command, livox::Sdk1Command::kHandshake);
  const auto handshake = livox::Sdk1Handshake::parse(frame.payload);
  ASSERT_TRUE(handshake);
  EXPECT_EQ(handshake->host_address, kLoopback);
  EXPECT_EQ(handshake->command_port, received->port);
  EXPECT_EQ(handshake->data_port, 56001);
  EXPECT_EQ(said, std::vector<std::string>{"3JEDK380010Z391 at 127.0.0.1 was found"});
  EXPECT_EQ(sut.cause(), "handshaking");
  EXPECT_EQ(sut.address(), 0U);  // not yet this host's
}

/// The next frame that came for a device with this command, among its first few.
std::optional<Bytes> payload_of(transport::DatagramSocket& device, livox::Sdk1Command command) {
  for (int i = 0; i < 10 && wait_for(device.fd()); ++i) {
    const auto received = device.receive();
    livox::Sdk1Frame frame;
    std::size_t size = 0;
    if (received && parse_sdk1_frame(received->payload, frame, size) == livox::FrameResult::kOk && frame.command == command) {
      return Bytes(frame.payload.begin(), frame.payload.end());
    }
  }
  return std::nullopt;
}

TEST(LivoxDevice, TellsAConnectedDeviceEachSecondOnceWhenConfigured) {
  for (const bool wanted : {true, false}) {
    configuration::Configuration configuration = avia(free_port());
    configuration.lidar.device.set_utc = wanted;
    LivoxDevice sut(configuration);
    transport::DatagramSocket device(0);
    const auto say = [](const std::string&, const std::string&) {};
    const Stamp now{std::chrono::seconds{1000}};
    sensor::GnssFix fix;
    fix.stamp = now;
    fix.quality = sensor::FixQuality::kSingle;
    fix.utc = sensor::UtcStamp(std::chrono::seconds{1'774'260'672});
    const auto say_to_host = [&](livox::Sdk1FrameType type, std::uint16_t number, livox::Sdk1Command command,
                                 std::span<const std::byte> payload, std::uint16_t port, int fd) {
      ASSERT_TRUE(device.send(livox::write_sdk1_frame({type, number, command, payload}).view(), kLoopback, port));
      ASSERT_TRUE(wait_for(fd));
      sut.run_once(now, {}, say);
    };
    sut.tell_time(fix, now);  // nobody is there
    say_to_host(livox::Sdk1FrameType::kMessage, 0, livox::Sdk1Command::kBroadcast,
                livox::Sdk1Broadcast{livox::DeviceCode::of("3JEDK380010Z391"), 7, 0}.bytes().view(), 55000, sut.fds().front());
    ASSERT_TRUE(wait_for(device.fd()));
    const auto handshake = device.receive();
    ASSERT_TRUE(handshake);
    livox::Sdk1Frame frame;
    std::size_t size = 0;
    ASSERT_EQ(parse_sdk1_frame(handshake->payload, frame, size), livox::FrameResult::kOk);
    say_to_host(livox::Sdk1FrameType::kAck, frame.sequence, livox::Sdk1Command::kHandshake, livox::one_byte(0).view(),
                handshake->port, sut.fds().back());
    ASSERT_NE(sut.address(), 0U);

    sut.tell_time(fix, now);
    const auto told = payload_of(device, livox::Sdk1Command::kSetUtc);
    sut.tell_time(fix, now);  // the same second

    ASSERT_EQ(told.has_value(), wanted);
    EXPECT_FALSE(payload_of(device, livox::Sdk1Command::kSetUtc));
    if (told) {
      EXPECT_EQ(livox::Sdk1Utc::parse(*told),
                (livox::Sdk1Utc{.year = 2026, .month = 3, .day = 23, .hour = 10, .in_hour_us = 672'000'000}));
    }
  }
}

TEST(DataWatch, IsOverdueOnceInThreeSecondsThatADeviceSamplesAndSendsNothing) {
  DataWatch sut;
  int overdue = 0;
  for (int ms = 0; ms < 10'000; ms += 100) {
    overdue += sut.is_overdue(true, Stamp{}, Stamp{std::chrono::milliseconds{ms}}) ? 1 : 0;
  }

  EXPECT_EQ(overdue, 3);
}

TEST(DataWatch, IsNotWhileDataArriveOrTheDeviceDoesNotSample) {
  DataWatch sut;
  for (int ms = 0; ms < 10'000; ms += 100) {
    const Stamp now{std::chrono::milliseconds{ms}};
    EXPECT_FALSE(sut.is_overdue(true, now - std::chrono::seconds{1}, now));
  }
  for (int ms = 10'000; ms < 20'000; ms += 100) {
    EXPECT_FALSE(sut.is_overdue(false, Stamp{std::chrono::seconds{9}}, Stamp{std::chrono::milliseconds{ms}}));
  }
  EXPECT_FALSE(sut.is_overdue(true, Stamp{std::chrono::seconds{9}}, Stamp{std::chrono::seconds{22}}));
}

TEST(LivoxDevice, SaysWhoHasItsCommandPort) {
  transport::DatagramSocket taken(0);

  EXPECT_THROW(LivoxDevice sut(avia(taken.port())), transport::TransportError);
}

}  // namespace
}  // namespace slamd::devices
