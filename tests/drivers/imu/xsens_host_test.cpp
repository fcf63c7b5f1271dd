#include "drivers/imu/xsens_host.hpp"

#include <gtest/gtest.h>

#include "stream_bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::imu {
namespace {

using Step = XsensHost::Step;

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};
// The golden vectors of imu-serial.md.
constexpr std::string_view kGoToConfig = "FAFF3000D1";
constexpr std::string_view kGoToMeasurement = "FAFF1000F1";
constexpr std::string_view kWakeUpAck = "FAFF3F00C2";
constexpr std::uint8_t kGoToConfigAck = 0x31;
constexpr std::uint8_t kConfigureAck = 0xC1;
constexpr std::uint8_t kGoToMeasurementAck = 0x11;

class XsensHostTest : public testing::Test {
 protected:
  /// What is sent since the last call.
  std::string sent() {
    const std::string hex = to_hex(out_.bytes.view());
    out_.bytes.clear();
    return hex;
  }

  void answer(std::uint8_t id, std::string_view hex = "") {
    const Bytes data = from_hex(hex);
    sut_.take({id, data}, now_, out_);
  }

  void pass(Duration time) {
    now_ += time;
    sut_.advance(now_, out_);
  }

  Stamp now_ = kBegin;
  LineOutput out_;
  XsensHost sut_;
};

TEST_F(XsensHostTest, SendsNothingBeforeItBegins) {
  pass(std::chrono::hours{1});
  answer(kGoToConfigAck);

  EXPECT_EQ(sent(), "");
  EXPECT_EQ(sut_.step(), Step::kEnded);
}

TEST_F(XsensHostTest, ConfiguresADeviceThatAnswers) {
  sut_.begin(400, now_, out_);
  EXPECT_EQ(sent(), kGoToConfig);

  answer(kGoToConfigAck);
  EXPECT_EQ(sut_.step(), Step::kConfigure);
  EXPECT_EQ(sent(), "FAFFC0141020FFFF1060FFFF4020019080200190E020FFFF71");

  answer(kConfigureAck, "1020FFFF1060FFFF4020019080200190E020FFFF");
  EXPECT_EQ(sut_.step(), Step::kGoToMeasurement);
  EXPECT_EQ(sent(), kGoToMeasurement);

  answer(kGoToMeasurementAck);
  EXPECT_EQ(sut_.step(), Step::kEnded);
  EXPECT_EQ(sut_.state(), DialogueState::kConfigured);
  EXPECT_EQ(sut_.rate_hz(), 400);
}

TEST_F(XsensHostTest, TellsTheRateThatTheDevicePromises) {
  sut_.begin(400, now_, out_);
  answer(kGoToConfigAck);

  answer(kConfigureAck, "1020FFFF1060FFFF4020006480200064E020FFFF");
  answer(kGoToMeasurementAck);

  EXPECT_EQ(sut_.rate_hz(), 100);
}

TEST_F(XsensHostTest, PassesOverSamplesAndForeignAnswers) {
  sut_.begin(400, now_, out_);
  sent();

  answer(xbus::kMtData2, "102002A986");
  answer(kConfigureAck);
  answer(kGoToMeasurementAck);

  EXPECT_EQ(sut_.step(), Step::kGoToConfig);
  EXPECT_EQ(sent(), "");
}

TEST_F(XsensHostTest, RepeatsEachCommandUntilItIsAnswered) {
  sut_.begin(400, now_, out_);
  sent();

  pass(XsensHost::kAnswerWait - std::chrono::milliseconds{1});
  EXPECT_EQ(sent(), "");
  pass(std::chrono::milliseconds{1});
  EXPECT_EQ(sent(), kGoToConfig);
  answer(kGoToConfigAck);
  const std::string configure = sent();
  pass(XsensHost::kAnswerWait);
  EXPECT_EQ(sent(), configure);
  answer(kConfigureAck);
  sent();
  pass(XsensHost::kAnswerWait);
  EXPECT_EQ(sent(), kGoToMeasurement);
}

TEST_F(XsensHostTest, GivesUpOnADeviceThatDoesNotAnswer) {
  sut_.begin(400, now_, out_);

  for (int i = 1; i < XsensHost::kTries; ++i) {
    pass(XsensHost::kAnswerWait);
    EXPECT_EQ(sut_.state(), DialogueState::kUnderWay);
  }
  EXPECT_EQ(out_.bytes.size(), 5U * XsensHost::kTries);
  pass(XsensHost::kAnswerWait);

  EXPECT_EQ(sut_.state(), DialogueState::kMute);
  EXPECT_EQ(sut_.step(), Step::kEnded);
}

TEST_F(XsensHostTest, LetsADeviceMeasureAsBeforeThatRefusesItsConfiguration) {
  sut_.begin(400, now_, out_);
  answer(kGoToConfigAck);
  sent();

  answer(xbus::kError, "04");
  EXPECT_EQ(sent(), kGoToMeasurement);
  answer(kGoToMeasurementAck);

  EXPECT_EQ(sut_.state(), DialogueState::kRefused);
  EXPECT_EQ(sut_.error(), 4);
}

TEST_F(XsensHostTest, HoldsADeviceThatWakesUpAndBeginsAgain) {
  sut_.begin(400, now_, out_);
  answer(kGoToConfigAck);
  sent();

  answer(xbus::kWakeUp);

  EXPECT_EQ(sent(), std::string(kWakeUpAck) + std::string(kGoToConfig));
  EXPECT_EQ(sut_.step(), Step::kGoToConfig);
}

TEST_F(XsensHostTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();

  const std::size_t allocations = support::count_allocations([&] {
    sut_.begin(400, now_, out_);
    sut_.take({kGoToConfigAck, {}}, now_, out_);
    sut_.take({kConfigureAck, {}}, now_, out_);
    sut_.advance(now_ + XsensHost::kAnswerWait, out_);
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::imu
