#include "tools/emulation/sdk2_device.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/livox/sdk2_host.hpp"
#include "emulated_wire.hpp"

namespace slamd::emulation {
namespace {

using hex::from_hex;
using hex::to_hex;
using livox::Endpoint;
using livox::Sdk2Command;
using livox::Sdk2Destination;
using livox::Sdk2Frame;
using livox::Sdk2Key;
using livox::Sdk2ValueWriter;

constexpr Endpoint kHost{kHostAddress, 56101};

Sdk2DeviceConfig config(std::uint32_t power_ups = 17) {
  Sdk2DeviceConfig config;
  config.address = kDeviceAddress;
  config.power_ups = power_ups;
  return config;
}

class Sdk2DeviceTest : public testing::Test {
 protected:
  Sdk2DeviceTest() : sut_(config(), Stamp{seconds{1000}}), wire_(sut_) {}

  /// What the device answers to a command, in hex.
  std::string ask(Sdk2Command command, std::span<const std::byte> payload) {
    const auto answer = wire_.ask(livox::write_sdk2_frame({++number_, command, false, false, payload}).view(), kHost, 56100);
    if (!answer) {
      return "";
    }
    Sdk2Frame frame;
    std::size_t size = 0;
    EXPECT_EQ(parse_sdk2_frame(answer->bytes.view(), frame, size), livox::FrameResult::kOk);
    EXPECT_TRUE(frame.ack && frame.from_device);
    EXPECT_EQ(frame.sequence, number_);
    EXPECT_EQ(answer->to, kHost);
    return to_hex(frame.payload);
  }

  std::string set(Sdk2Key key, std::span<const std::byte> value) {
    Sdk2ValueWriter values;
    values.add(key, value);
    return ask(Sdk2Command::kSetParameters, values.payload());
  }

  std::string set(Sdk2Key key, std::uint8_t value) { return set(key, livox::one_byte(value).view()); }

  std::string get(Sdk2Key key) { return ask(Sdk2Command::kGetParameters, livox::sdk2_question({&key, 1}).view()); }

  /// Has it send here and sample.
  void start() {
    wire_.run(milliseconds{1100});
    set(Sdk2Key::kStateDestination, Sdk2Destination{kHostAddress, 56201, 56200}.bytes().view());
    set(Sdk2Key::kPointDestination, Sdk2Destination{kHostAddress, 56301, 56300}.bytes().view());
    set(Sdk2Key::kImuDestination, Sdk2Destination{kHostAddress, 56401, 56400}.bytes().view());
    set(Sdk2Key::kWorkMode, 1);
    wire_.run(milliseconds{600});
  }

  Sdk2Device sut_;
  EmulatedWire wire_;
  std::uint32_t number_ = 0;
};

TEST_F(Sdk2DeviceTest, AnswersWhoeverLooksForIt) {
  // livox-sdk2.md, golden vectors: discovery and its answer
  const auto answer = wire_.ask(from_hex("AA0018000100000000000000000000000000A91F00000000"), {kHostAddress, 56000}, 56000);

  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->to, (Endpoint{kHostAddress, 56000}));
  EXPECT_EQ(answer->from_port, 56000);
  EXPECT_EQ(to_hex(answer->bytes.view()),
            "AA00300001000000000001010000000000008AB7378C8B17000934374D444C3132333435363738393000C0A8017024DB");
}

TEST_F(Sdk2DeviceTest, TestsItselfIsIdleStartsItsMotorAndSamples) {
  EXPECT_EQ(sut_.state(), Sdk2DeviceState::kSelfTest);
  wire_.run(milliseconds{1100});
  EXPECT_EQ(sut_.state(), Sdk2DeviceState::kIdle);

  EXPECT_EQ(set(Sdk2Key::kWorkMode, 1), "000000");

  EXPECT_EQ(sut_.state(), Sdk2DeviceState::kMotorStarts);
  wire_.run(milliseconds{600});
  EXPECT_EQ(sut_.state(), Sdk2DeviceState::kSampling);
  EXPECT_EQ(get(Sdk2Key::kWorkState), "0001000680010001");
  set(Sdk2Key::kWorkMode, 2);
  EXPECT_EQ(sut_.state(), Sdk2DeviceState::kIdle);
}

TEST_F(Sdk2DeviceTest, SamplesOnceItIsReadyWhenItWasToldBefore) {
  set(Sdk2Key::kWorkMode, 1);
  EXPECT_EQ(sut_.state(), Sdk2DeviceState::kSelfTest);

  wire_.run(milliseconds{1700});

  EXPECT_EQ(sut_.state(), Sdk2DeviceState::kSampling);
}

TEST_F(Sdk2DeviceTest, SendsWhereItIsToldAndNothingToNobody) {
  wire_.run(milliseconds{1100});
  set(Sdk2Key::kWorkMode, 1);
  wire_.run(milliseconds{600});
  EXPECT_FALSE(sut_.destination(Stream::kPoints));  // from the factory it sends nowhere

  start();

  EXPECT_EQ(sut_.destination(Stream::kPoints), (Endpoint{kHostAddress, 56301}));
  EXPECT_EQ(sut_.destination(Stream::kImu), (Endpoint{kHostAddress, 56401}));
  set(Sdk2Key::kImuEnable, 0);
  EXPECT_FALSE(sut_.destination(Stream::kImu));
  set(Sdk2Key::kPointSend, 1);  // 1 does not send
  EXPECT_FALSE(sut_.destination(Stream::kPoints));
}

TEST_F(Sdk2DeviceTest, TellsItsStateOnceASecondAndChangesAtOnce) {
  start();
  wire_.sent.clear();

  wire_.run(milliseconds{3950});
  EXPECT_EQ(wire_.sent.size(), 4U);
  EXPECT_EQ(wire_.sent[0].to, (Endpoint{kHostAddress, 56201}));
  EXPECT_EQ(wire_.sent[0].from_port, 56200);
  set(Sdk2Key::kWorkMode, 2);
  wire_.run(milliseconds{10});

  EXPECT_EQ(wire_.sent.size(), 5U);
}

TEST_F(Sdk2DeviceTest, SaysWhyItDoesNotTakeAParameter) {
  EXPECT_EQ(set(static_cast<Sdk2Key>(0x0021), 1), "202100");  // unsupported
  EXPECT_EQ(set(Sdk2Key::kWorkState, 1), "220680");           // read-only
  EXPECT_EQ(set(Sdk2Key::kPointDestination, 1), "230600");    // bad length
  EXPECT_EQ(set(Sdk2Key::kPointType, 3), "020000");           // not possible now
  EXPECT_EQ(set(Sdk2Key::kWorkMode, 9), "031A00");            // out of range
  EXPECT_EQ(get(static_cast<Sdk2Key>(0x0021)), "200000");
}

TEST_F(Sdk2DeviceTest, TakesTheTime) {
  EXPECT_EQ(ask(Sdk2Command::kGpsTime, livox::Sdk2GpsTime{1'795'327'324'000'000'000}.bytes().view()), "00");

  ASSERT_TRUE(sut_.gps_time());
  EXPECT_EQ(sut_.gps_time()->utc_ns, 1'795'327'324'000'000'000U);
}

TEST_F(Sdk2DeviceTest, SaysNothingToWhatItDoesNotUnderstand) {
  EXPECT_FALSE(wire_.ask(from_hex("AA0018000100000000000000000000000000A91F00000001"), kHost, 56000));
  EXPECT_FALSE(wire_.ask(from_hex("AA0018000100000000000000000000000000A91F00000000"), kHost, 56100));
  EXPECT_EQ(ask(Sdk2Command::kReboot, {}), "01");
}

TEST_F(Sdk2DeviceTest, AnswersNoQuestionThatIsLongerThanAFrame) {
  std::vector<Sdk2Key> keys(30, Sdk2Key::kHealth);

  EXPECT_EQ(ask(Sdk2Command::kGetParameters, livox::sdk2_question(keys).view()), "010000");
}

TEST_F(Sdk2DeviceTest, SurvivesAnyFramesAndIsStillToBeHad) {
  std::mt19937 random(8);
  constexpr Sdk2Command kCommands[] = {Sdk2Command::kSetParameters, Sdk2Command::kGetParameters, Sdk2Command::kGpsTime,
                                       Sdk2Command::kDiscovery, Sdk2Command::kStatePush};
  for (int round = 0; round < 3000; ++round) {
    std::vector<std::byte> payload(random() % 60);
    for (std::byte& byte : payload) {
      byte = static_cast<std::byte>(random() % 4);
    }
    const auto frame =
        livox::write_sdk2_frame({1, kCommands[random() % 5], random() % 4 == 0, random() % 4 == 0, payload});
    wire_.ask(frame.view(), kHost, random() % 2 == 0 ? 56000 : 56100);
    if (round % 7 == 0) {
      wire_.run(milliseconds{10});
    }
  }

  livox::Sdk2Host host({});
  wire_.join(host, kHostAddress);
  wire_.run(seconds{5});
  EXPECT_TRUE(host.is_sampling());
}

TEST_F(Sdk2DeviceTest, IsFoundSetAndStartedBySlamdsHostAndFoundAgainAfterEachLoss) {
  livox::Sdk2Host host({});
  wire_.join(host, kHostAddress);
  wire_.run(seconds{4});
  ASSERT_TRUE(host.is_sampling());
  EXPECT_EQ(sut_.destination(Stream::kPoints), (Endpoint{kHostAddress, 56301}));

  wire_.plugged = false;
  wire_.run(seconds{6});
  EXPECT_FALSE(host.is_connected());
  wire_.plugged = true;
  wire_.run(seconds{2});
  EXPECT_TRUE(host.is_sampling());

  sut_ = Sdk2Device(config(18), wire_.now);  // switched off and on, faster than silence would show
  wire_.run(seconds{4});
  EXPECT_TRUE(host.is_sampling());
  EXPECT_EQ(sut_.destination(Stream::kPoints), (Endpoint{kHostAddress, 56301}));

  wire_.leave(host);  // killed; its successor knows nothing
  livox::Sdk2Host successor({});
  wire_.join(successor, kHostAddress);
  wire_.run(seconds{3});
  EXPECT_TRUE(successor.is_sampling());
}

TEST_F(Sdk2DeviceTest, IsSetAgainBySlamdsHostWhenItsDataDoNotArrive) {
  livox::Sdk2Host host({});
  wire_.join(host, kHostAddress);
  wire_.run(seconds{4});
  set(Sdk2Key::kPointSend, 1);  // by another program; the state does not tell
  wire_.run(seconds{2});
  ASSERT_TRUE(host.is_sampling());
  ASSERT_FALSE(sut_.destination(Stream::kPoints));

  livox::HostOutput out;
  host.set_again(wire_.now, out);
  wire_.run(seconds{2});

  EXPECT_TRUE(sut_.destination(Stream::kPoints));
  EXPECT_TRUE(host.is_sampling());
}

TEST_F(Sdk2DeviceTest, YieldsToAnotherHostWhichTheFirstIsToldOf) {
  livox::Sdk2Host host({});
  wire_.join(host, kHostAddress);
  wire_.run(seconds{4});

  set(Sdk2Key::kPointDestination, Sdk2Destination{kOtherAddress, 56301, 56300}.bytes().view());
  wire_.run(seconds{2});

  EXPECT_EQ(host.state(), livox::Sdk2HostState::kHeld);
  EXPECT_EQ(sut_.destination(Stream::kPoints), (Endpoint{kOtherAddress, 56301}));
}

}  // namespace
}  // namespace slamd::emulation
