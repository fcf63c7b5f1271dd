#include "tools/emulation/sdk1_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "drivers/livox/sdk1_host.hpp"
#include "emulated_wire.hpp"

namespace slamd::emulation {
namespace {

using hex::from_hex;
using hex::to_hex;
using livox::Endpoint;
using livox::one_byte;
using livox::Payload;
using livox::Sdk1Command;
using livox::Sdk1Frame;
using livox::Sdk1FrameType;

constexpr Endpoint kHost{kHostAddress, 55501};
constexpr Endpoint kOther{kOtherAddress, 55501};

class Sdk1DeviceTest : public testing::Test {
 protected:
  Sdk1DeviceTest() : sut_({}, Stamp{seconds{1000}}), wire_(sut_) {}

  /// What the device answers to a command, in hex; "" when it does not.
  std::string ask(Sdk1Command command, const Payload& payload = {}, Endpoint from = kHost) {
    const auto frame = livox::write_sdk1_frame({Sdk1FrameType::kCommand, ++number_, command, payload.view()});
    answer_ = wire_.ask(frame.view(), from, Sdk1Device::kCommandPort);
    if (!answer_) {
      return "";
    }
    Sdk1Frame answer;
    std::size_t size = 0;
    EXPECT_EQ(parse_sdk1_frame(answer_->bytes.view(), answer, size), livox::FrameResult::kOk);
    EXPECT_EQ(answer.type, Sdk1FrameType::kAck);
    EXPECT_EQ(answer.sequence, number_);
    EXPECT_EQ(answer.command, command);
    return to_hex(answer.payload);
  }

  std::string shake_hands(std::uint32_t host = kHostAddress) {
    return ask(Sdk1Command::kHandshake, livox::Sdk1Handshake{host, 56001, 55501, 56003}.bytes(), {host, 55501});
  }

  /// Brings it to where it samples.
  void start() {
    wire_.run(milliseconds{1100});
    shake_hands();
    ask(Sdk1Command::kSampling, one_byte(1));
  }

  Sdk1Device sut_;
  EmulatedWire wire_;
  std::optional<DeviceOutput::Datagram> answer_;
  std::uint16_t number_ = 0;
};

TEST_F(Sdk1DeviceTest, LooksForAHostOnceASecond) {
  wire_.run(milliseconds{4500});

  ASSERT_EQ(wire_.sent.size(), 5U);
  EXPECT_EQ(wire_.sent[0].to, (Endpoint{livox::kEverybody, 55000}));
  EXPECT_EQ(wire_.sent[0].from_port, 65000);
  // livox-sdk1.md, golden vectors: the broadcast
  EXPECT_EQ(to_hex(wire_.sent[0].bytes.view()), "AA012200020000597E0000334A45444B3338303031305A333931000700009DBD7AD7");
}

TEST_F(Sdk1DeviceTest, TakesAHandshakeAndAnswersAtThePortThatItNames) {
  EXPECT_EQ(shake_hands(), "00");

  EXPECT_EQ(answer_->to, kHost);
  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kHeld);
  wire_.run(seconds{3});
  EXPECT_TRUE(wire_.sent.empty());  // it looks no longer
}

TEST_F(Sdk1DeviceTest, TakesHandshakesOfBothTypesThatHostsSend) {
  for (const char* golden : {"AA01190000010004410001C0A80132C1DACDD8C1DA50E156F8",
                             "AA011900010100D81B0001C0A80132C1DACDD8C1DA16CEA8C2"}) {
    const auto answer = wire_.ask(from_hex(golden), kHost, Sdk1Device::kCommandPort);

    ASSERT_TRUE(answer);
    EXPECT_EQ(to_hex(answer->bytes.view()), "AA011000010100BC4A000100C813DF1B");
  }
}

TEST_F(Sdk1DeviceTest, RefusesAnotherHostWhileItIsHeld) {
  shake_hands();

  EXPECT_EQ(shake_hands(kOtherAddress), "01");
  EXPECT_EQ(ask(Sdk1Command::kSampling, one_byte(0), kOther), "01");

  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kHeld);
  EXPECT_EQ(wire_.news.back(), "refuses 192.168.1.51, for it is another host's");
}

TEST_F(Sdk1DeviceTest, TellsItsProgressWhileItInitialisesAndDoesNotSample) {
  wire_.run(milliseconds{420});
  shake_hands();

  EXPECT_EQ(ask(Sdk1Command::kHeartbeat), "0000002A000000");
  EXPECT_EQ(ask(Sdk1Command::kSampling, one_byte(1)), "01");
  wire_.run(milliseconds{600});

  EXPECT_EQ(ask(Sdk1Command::kHeartbeat), "00010000000000");
  EXPECT_EQ(ask(Sdk1Command::kSampling, one_byte(1)), "00");
}

TEST_F(Sdk1DeviceTest, SendsWhereTheHandshakeSaysBetweenStartAndStop) {
  wire_.run(milliseconds{1100});
  shake_hands();
  EXPECT_FALSE(sut_.destination(Stream::kPoints));

  ask(Sdk1Command::kSampling, one_byte(1));

  EXPECT_EQ(sut_.destination(Stream::kPoints), (Endpoint{kHostAddress, 56001}));
  EXPECT_EQ(sut_.destination(Stream::kImu), (Endpoint{kHostAddress, 56003}));
  EXPECT_EQ(ask(Sdk1Command::kSampling, one_byte(0)), "00");
  EXPECT_FALSE(sut_.destination(Stream::kPoints));
  EXPECT_FALSE(sut_.destination(Stream::kImu));
}

TEST_F(Sdk1DeviceTest, SwitchesItsInertialSensor) {
  start();

  EXPECT_EQ(ask(Sdk1Command::kSetImuRate, one_byte(0)), "00");
  EXPECT_EQ(ask(Sdk1Command::kGetImuRate), "0000");
  EXPECT_FALSE(sut_.destination(Stream::kImu));
  EXPECT_EQ(ask(Sdk1Command::kSetImuRate, one_byte(1)), "00");
  EXPECT_TRUE(sut_.destination(Stream::kImu));
  EXPECT_EQ(ask(Sdk1Command::kSetImuRate, one_byte(2)), "01");
}

TEST_F(Sdk1DeviceTest, TakesOnlyWhatItsDriveIsSimulatedIn) {
  shake_hands();

  EXPECT_EQ(ask(Sdk1Command::kCoordinate, one_byte(0)), "00");
  EXPECT_EQ(ask(Sdk1Command::kCoordinate, one_byte(1)), "01");
  EXPECT_EQ(ask(Sdk1Command::kSetReturnMode, one_byte(0)), "00");
  EXPECT_EQ(ask(Sdk1Command::kSetReturnMode, one_byte(3)), "01");
  EXPECT_EQ(ask(Sdk1Command::kGetReturnMode), "0000");
}

TEST_F(Sdk1DeviceTest, KeepsItsExtrinsicAndTheTime) {
  shake_hands();
  const Payload extrinsic = livox::Sdk1Extrinsic{{1.0F, -2.0F, 90.0F}, {100, -200, 300}}.bytes();

  EXPECT_EQ(ask(Sdk1Command::kSetExtrinsic, extrinsic), "00");
  EXPECT_EQ(ask(Sdk1Command::kGetExtrinsic), "00" + to_hex(extrinsic.view()));
  EXPECT_EQ(ask(Sdk1Command::kSetUtc, livox::Sdk1Utc{2026, 11, 22, 6, 124'000'000}.bytes()), "00");
  EXPECT_EQ(sut_.utc(), (livox::Sdk1Utc{2026, 11, 22, 6, 124'000'000}));
  EXPECT_EQ(ask(Sdk1Command::kDeviceInfo), "000B060000");
}

/// A device whose PPS line beats on whole seconds of the wire's time, which is 2026-11-22 06:00:00 at 1000 s.
class Sdk1DeviceWithPps : public Sdk1DeviceTest {
 protected:
  Sdk1DeviceWithPps() {
    Sdk1DeviceConfig config;
    config.utc_minus_own = std::chrono::sys_days{std::chrono::November / 22 / 2026}.time_since_epoch() +
                           std::chrono::hours{6} - seconds{1000};
    sut_ = Sdk1Device(config, wire_.now);
  }

  /// The header of a data packet that was taken now.
  std::string header() {
    std::vector<std::byte> packet(42);
    packet[8] = std::byte{0};
    sut_.stamp(packet, wire_.now);
    return to_hex(std::span(packet).subspan(4, 14));
  }
};

TEST_F(Sdk1DeviceWithPps, FollowsPpsFromItsFirstEdgeOn) {
  wire_.run(milliseconds{990});
  shake_hands();
  EXPECT_EQ(sut_.time_sync(), livox::TimeSync::kNone);
  EXPECT_EQ(header(), "0002000000000000000000000000");  // PPS is there

  wire_.run(milliseconds{260});

  EXPECT_EQ(wire_.news.back(), "follows PPS");
  EXPECT_EQ(ask(Sdk1Command::kHeartbeat), "00010000C20000");  // 3 << 14 | PPS
  EXPECT_EQ(header(), "00C20000040080B2E60E00000000");        // type 4, 250,000,000 ns
}

TEST_F(Sdk1DeviceWithPps, FollowsGpsOnceItWasToldTheUtcInTime) {
  wire_.run(milliseconds{1100});
  shake_hands();

  EXPECT_EQ(ask(Sdk1Command::kSetUtc, livox::Sdk1Utc{2026, 11, 22, 6, 124'000'000}.bytes()), "00");  // of its own clock

  EXPECT_EQ(wire_.news.back(), "follows GPS");
  EXPECT_EQ(ask(Sdk1Command::kHeartbeat), "00010000820000");  // 2 << 14 | PPS
  wire_.run(seconds{2});
  EXPECT_EQ(header(), "0082000003001A0B160620228407");  // type 3, 2026-11-22 06 h, 126,100,000 us
  EXPECT_EQ(sut_.utc_told(), 1U);
  EXPECT_EQ(sut_.utc_unused(), 0U);
}

TEST_F(Sdk1DeviceWithPps, DoesNotUseAUtcThatComesTooEarlyOrTooLate) {
  shake_hands();
  const Payload utc = livox::Sdk1Utc{2026, 11, 22, 6, 1'000'000}.bytes();
  wire_.run(milliseconds{1000});
  EXPECT_EQ(ask(Sdk1Command::kSetUtc, utc), "00");
  wire_.run(milliseconds{510});
  EXPECT_EQ(ask(Sdk1Command::kSetUtc, utc), "00");

  EXPECT_EQ(sut_.time_sync(), livox::TimeSync::kPps);
  EXPECT_EQ(sut_.utc_told(), 2U);
  EXPECT_EQ(sut_.utc_unused(), 2U);
}

TEST_F(Sdk1DeviceTest, CannotUseTheUtcWithoutPps) {
  start();

  EXPECT_EQ(ask(Sdk1Command::kSetUtc, livox::Sdk1Utc{2026, 11, 22, 6, 124'000'000}.bytes()), "00");

  EXPECT_EQ(sut_.time_sync(), livox::TimeSync::kNone);
  EXPECT_EQ(sut_.utc_unused(), 1U);
  EXPECT_EQ(ask(Sdk1Command::kHeartbeat), "00010000000000");
}

TEST_F(Sdk1DeviceTest, TellsSlamdsHostTheExtrinsicThatIsStored) {
  Sdk1DeviceConfig config;
  config.extrinsic = {{0.0F, 0.0F, 90.0F}, {100, -200, 300}};
  sut_ = Sdk1Device(config, wire_.now);
  livox::Sdk1Host host({});
  wire_.join(host, kHostAddress);

  wire_.run(seconds{4});

  EXPECT_EQ(host.extrinsic(), config.extrinsic);
}

TEST_F(Sdk1DeviceTest, RestsAndWakesWhenTold) {
  start();

  EXPECT_EQ(ask(Sdk1Command::kSetMode, one_byte(3)), "00");
  EXPECT_FALSE(sut_.destination(Stream::kPoints));
  EXPECT_EQ(ask(Sdk1Command::kHeartbeat), "00030000000000");
  EXPECT_EQ(ask(Sdk1Command::kSampling, one_byte(1)), "01");
  EXPECT_EQ(ask(Sdk1Command::kSetMode, one_byte(1)), "00");
  EXPECT_EQ(ask(Sdk1Command::kSampling, one_byte(1)), "00");
  EXPECT_EQ(ask(Sdk1Command::kSetMode, one_byte(4)), "01");
}

TEST_F(Sdk1DeviceTest, GivesItsHostUpFiveSecondsAfterTheLastHeartbeat) {
  start();
  wire_.run(seconds{4});
  ask(Sdk1Command::kHeartbeat);
  wire_.run(milliseconds{4900});
  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kSampling);

  wire_.run(milliseconds{200});

  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kLooking);
  EXPECT_FALSE(sut_.destination(Stream::kPoints));
  EXPECT_EQ(wire_.news.back(), "looks for a host: 192.168.1.50 has fallen silent");
  EXPECT_EQ(shake_hands(kOtherAddress), "00");
}

TEST_F(Sdk1DeviceTest, IsLetGo) {
  start();

  EXPECT_EQ(ask(Sdk1Command::kDisconnect), "00");

  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kLooking);
  EXPECT_EQ(ask(Sdk1Command::kHeartbeat), "");  // it is nobody's
}

TEST_F(Sdk1DeviceTest, PushesWhatIsWrongTenTimesASecond) {
  start();
  wire_.sent.clear();
  sut_.set_status(0x40000001);

  wire_.run(milliseconds{950});

  EXPECT_EQ(wire_.sent.size(), 10U);
  EXPECT_EQ(wire_.sent[0].to, kHost);
  sut_.set_status(0);
  wire_.run(seconds{1});
  EXPECT_EQ(wire_.sent.size(), 10U);
}

TEST_F(Sdk1DeviceTest, SaysNothingToWhatItDoesNotUnderstand) {
  shake_hands();

  EXPECT_FALSE(wire_.ask(from_hex("AA010F0000000004D7000338BA8D0D"), kHost, Sdk1Device::kCommandPort));
  EXPECT_FALSE(wire_.ask(from_hex("00"), kHost, Sdk1Device::kCommandPort));
  EXPECT_FALSE(wire_.ask(from_hex("AA010F0000000004D7000338BA8D0C"), kHost, Sdk1Device::kPointPort));
  EXPECT_EQ(ask(Sdk1Command::kReboot), "01");
}

TEST_F(Sdk1DeviceTest, SurvivesAnyFramesAndIsStillToBeHad) {
  std::mt19937 random(7);
  for (int round = 0; round < 3000; ++round) {
    Payload payload;
    for (std::size_t i = random() % 30; i > 0; --i) {
      payload.push_back(static_cast<std::byte>(random() % 4));
    }
    const auto command = static_cast<Sdk1Command>((random() % 2) << 8 | random() % 16);
    const auto frame = livox::write_sdk1_frame({static_cast<Sdk1FrameType>(random() % 3), 1, command, payload.view()});
    wire_.ask(frame.view(), random() % 2 == 0 ? kHost : kOther, Sdk1Device::kCommandPort);
    if (round % 7 == 0) {
      wire_.run(milliseconds{10});
    }
  }
  wire_.run(seconds{6});

  EXPECT_EQ(shake_hands(), "00");
  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kHeld);
}

TEST_F(Sdk1DeviceTest, IsFoundSetAndStartedBySlamdsHostAndFoundAgainAfterEachLoss) {
  livox::Sdk1Host host({});
  wire_.join(host, kHostAddress);
  wire_.run(seconds{4});
  ASSERT_TRUE(host.is_sampling());
  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kSampling);
  wire_.run(seconds{20});  // heartbeats keep it
  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kSampling);

  wire_.plugged = false;
  wire_.run(seconds{7});
  EXPECT_FALSE(host.is_connected());
  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kLooking);
  wire_.plugged = true;
  wire_.run(seconds{3});
  EXPECT_TRUE(host.is_sampling());

  sut_ = Sdk1Device({}, wire_.now);  // switched off and on
  wire_.run(seconds{4});
  EXPECT_TRUE(host.is_sampling());
  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kSampling);

  wire_.leave(host);  // killed; its successor knows nothing
  livox::Sdk1Host successor({});
  wire_.join(successor, kHostAddress);
  wire_.run(seconds{9});
  EXPECT_TRUE(successor.is_sampling());
}

TEST_F(Sdk1DeviceTest, IsSetAgainBySlamdsHostWhenItsDataDoNotArrive) {
  livox::Sdk1Host host({});
  wire_.join(host, kHostAddress);
  wire_.run(seconds{4});
  ask(Sdk1Command::kSampling, one_byte(0));  // by another program on the host's computer
  wire_.run(seconds{2});
  ASSERT_TRUE(host.is_sampling());  // heartbeats do not tell
  ASSERT_EQ(sut_.state(), Sdk1DeviceState::kHeld);

  livox::HostOutput out;
  host.set_again(wire_.now, out);
  wire_.run(seconds{1});

  EXPECT_EQ(sut_.state(), Sdk1DeviceState::kSampling);
  ASSERT_FALSE(out.events.empty());
  EXPECT_EQ(out.events[0].kind, livox::HostEventKind::kNoData);
}

TEST_F(Sdk1DeviceTest, TellsSlamdsSecondHostThatItIsHeld) {
  livox::Sdk1Host first({});
  livox::Sdk1Host second({});
  wire_.join(first, kHostAddress);
  wire_.join(second, kOtherAddress);  // hears the same broadcast

  wire_.run(seconds{3});

  EXPECT_TRUE(first.is_sampling());
  EXPECT_FALSE(second.is_connected());
  const auto held = std::find_if(wire_.events.begin(), wire_.events.end(),
                                 [](const auto& event) { return event.kind == livox::HostEventKind::kHeldByOther; });
  ASSERT_NE(held, wire_.events.end());
  EXPECT_NE(words_for(*held).find("is held by another host"), std::string::npos);
}

}  // namespace
}  // namespace slamd::emulation
