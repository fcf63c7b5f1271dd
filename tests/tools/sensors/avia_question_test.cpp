#include "tools/sensors/avia_question.hpp"

#include <gtest/gtest.h>

#include "made_bytes.hpp"
#include "tools/emulation/sdk1_device.hpp"

namespace slamd::sensors {
namespace {

using emulation::Sdk1Device;
using emulation::Sdk1DeviceState;

constexpr livox::Endpoint kOwn{kHost, 40000};
constexpr livox::Endpoint kOther{0x0A4D0009, 55501};

class AviaQuestionTest : public testing::Test {
 protected:
  AviaQuestionTest() : device_({}, kBegin) {}

  /// What the device answers to a frame of a host's; empty: nothing.
  Bytes ask(std::span<const std::byte> frame, livox::Endpoint host) {
    emulation::DeviceOutput out;
    device_.receive(frame, host, Sdk1Device::kCommandPort, kBegin, out);
    return out.datagrams.empty() ? Bytes{} : bytes_of(out.datagrams.back().bytes);
  }

  void be_taken_by(livox::Endpoint host) {
    const livox::Sdk1Handshake handshake{host.address, 56001, host.port, 56001};
    ask(livox::write_sdk1_frame({livox::Sdk1FrameType::kCommand, 1, livox::Sdk1Command::kHandshake, handshake.bytes().view()}).view(), host);
  }

  Sdk1Device device_;
  AviaQuestion sut_{kSensor};
};

TEST_F(AviaQuestionTest, HearsARefusalOfADeviceThatHasAHost) {
  be_taken_by(kOther);

  const auto farewell = sut_.take(ask(sut_.question(kHost, kOwn.port).view(), kOwn));

  EXPECT_EQ(sut_.answer(), AviaAnswer::kRefusal);
  EXPECT_TRUE(farewell.empty());
  EXPECT_TRUE(sut_.question(kHost, kOwn.port).empty());
  EXPECT_EQ(device_.state(), Sdk1DeviceState::kHeld);
}

TEST_F(AviaQuestionTest, LetsADeviceGoThatHadNone) {
  const auto farewell = sut_.take(ask(sut_.question(kHost, kOwn.port).view(), kOwn));
  ASSERT_EQ(device_.state(), Sdk1DeviceState::kHeld);

  sut_.take(ask(farewell.view(), kOwn));

  EXPECT_EQ(sut_.answer(), AviaAnswer::kConsent);
  EXPECT_EQ(device_.state(), Sdk1DeviceState::kLooking);
  EXPECT_TRUE(sut_.question(kHost, kOwn.port).empty());
}

TEST_F(AviaQuestionTest, AsksThreeTimesAndNoMore) {
  EXPECT_EQ(sut_.answer(), AviaAnswer::kNotAsked);
  for (int i = 0; i < AviaQuestion::kTries; ++i) {
    EXPECT_FALSE(sut_.question(kHost, kOwn.port).empty());
  }

  EXPECT_TRUE(sut_.question(kHost, kOwn.port).empty());
  EXPECT_EQ(sut_.answer(), AviaAnswer::kNone);
}

TEST_F(AviaQuestionTest, TakesNothingElseForAnAnswer) {
  sut_.question(kHost, kOwn.port);

  sut_.take({});
  sut_.take(text_bytes("hello"));
  sut_.take(sdk1_broadcast("3JEDK380010Z391"));
  sut_.take(livox::write_sdk1_frame({livox::Sdk1FrameType::kAck, 1, livox::Sdk1Command::kHeartbeat, livox::one_byte(1).view()}).view());
  sut_.take(livox::write_sdk1_frame({livox::Sdk1FrameType::kAck, 1, livox::Sdk1Command::kHandshake, {}}).view());

  EXPECT_EQ(sut_.answer(), AviaAnswer::kNone);
}

}  // namespace
}  // namespace slamd::sensors
