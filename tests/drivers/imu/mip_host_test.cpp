#include "drivers/imu/mip_host.hpp"

#include <gtest/gtest.h>

#include "stream_bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::imu {
namespace {

using Step = MipHost::Step;

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};

class MipHostTest : public testing::Test {
 protected:
  /// The payloads of what is sent since the last call, each behind its set.
  std::string sent() {
    std::string text;
    ByteFrames<Mip> frames;
    frames.add(out_.bytes.view(), [&](std::span<const std::byte> frame) {
      const MipPacket packet = Mip::parse(frame);
      const std::byte set{packet.set};
      text += (text.empty() ? "" : " ") + to_hex(std::span(&set, 1)) + ":" + to_hex(packet.payload);
    });
    EXPECT_EQ(frames.counters().frame_bytes, out_.bytes.size());
    out_.bytes.clear();
    return text;
  }

  void answer(std::uint8_t set, std::string_view hex) {
    const Bytes payload = from_hex(hex);
    sut_.take({set, payload}, now_, out_);
  }

  void pass(Duration time) {
    now_ += time;
    sut_.advance(now_, out_);
  }

  /// Goes on to the format, at a base rate of 1 kHz.
  void reach_format(int rate_hz) {
    sut_.begin(rate_hz, now_, out_);
    answer(0x01, "04F10200");
    answer(0x0C, "04F10E00058E8003E8");
    ASSERT_EQ(sut_.step(), Step::kFormat);
  }

  Stamp now_ = kBegin;
  LineOutput out_;
  MipHost sut_;
};

TEST_F(MipHostTest, SendsNothingBeforeItBegins) {
  pass(std::chrono::hours{1});
  answer(0x01, "04F10200");

  EXPECT_EQ(sent(), "");
  EXPECT_EQ(sut_.step(), Step::kEnded);
}

TEST_F(MipHostTest, ConfiguresADeviceThatAnswers) {
  sut_.begin(250, now_, out_);
  EXPECT_EQ(sent(), "01:0202");

  answer(0x01, "04F10200");
  EXPECT_EQ(sut_.step(), Step::kBaseRate);
  EXPECT_EQ(sent(), "0C:030E80");

  answer(0x0C, "04F10E00058E8003E8");
  EXPECT_EQ(sut_.step(), Step::kFormat);
  EXPECT_EQ(sent(), "0C:140F018005D50004D60004040004050004180004");

  answer(0x0C, "04F10F00");
  EXPECT_EQ(sut_.step(), Step::kStream);
  EXPECT_EQ(sent(), "0C:0511018001");

  answer(0x0C, "04F11100");
  EXPECT_EQ(sut_.step(), Step::kResume);
  EXPECT_EQ(sent(), "01:0206");

  answer(0x01, "04F10600");
  EXPECT_EQ(sut_.step(), Step::kEnded);
  EXPECT_EQ(sut_.state(), DialogueState::kConfigured);
  EXPECT_EQ(sut_.rate_hz(), 250);
}

TEST_F(MipHostTest, TakesTheNearestPartOfTheBaseRate) {
  reach_format(400);

  EXPECT_EQ(sut_.rate_hz(), 333);
}

TEST_F(MipHostTest, NeverAsksForMoreThanTheBaseRate) {
  reach_format(2000);

  EXPECT_EQ(sut_.rate_hz(), 1000);
}

TEST_F(MipHostTest, LeavesOutTheFieldsThatAModelDoesNotHave) {
  reach_format(1000);
  sent();

  answer(0x0C, "04F10F03");
  EXPECT_EQ(sent(), "0C:110F018004D50001D60001040001050001");
  answer(0x0C, "04F10F03");
  EXPECT_EQ(sent(), "0C:0E0F018003D50001040001050001");
  answer(0x0C, "04F10F03");
  EXPECT_EQ(sent(), "0C:0E0F018003120001040001050001");
  answer(0x0C, "04F10F00");

  EXPECT_EQ(sut_.step(), Step::kStream);
}

TEST_F(MipHostTest, ResumesADeviceThatRefusesEveryFormat) {
  reach_format(1000);

  for (int i = 0; i < 4; ++i) {
    answer(0x0C, "04F10F03");
  }
  EXPECT_EQ(sut_.step(), Step::kResume);
  answer(0x01, "04F10600");

  EXPECT_EQ(sut_.state(), DialogueState::kRefused);
  EXPECT_EQ(sut_.error(), 3);
}

TEST_F(MipHostTest, ResumesADeviceThatDoesNotTellItsBaseRate) {
  for (const std::string_view reply : {"04F10E01", "04F10E00", "04F10E00058E800000"}) {
    sut_.begin(250, now_, out_);
    answer(0x01, "04F10200");

    answer(0x0C, reply);
    EXPECT_EQ(sut_.step(), Step::kResume) << reply;
    answer(0x01, "04F10600");

    EXPECT_EQ(sut_.state(), DialogueState::kRefused);
    out_.bytes.clear();
  }
}

TEST_F(MipHostTest, GoesOnWhereAModelHasNoIdleStateAndNoStreamToEnable) {
  sut_.begin(1000, now_, out_);
  answer(0x01, "04F10201");
  EXPECT_EQ(sut_.step(), Step::kBaseRate);
  answer(0x0C, "04F10E00058E8003E8");
  answer(0x0C, "04F10F00");

  answer(0x0C, "04F11101");

  EXPECT_EQ(sut_.step(), Step::kResume);
}

TEST_F(MipHostTest, PassesOverSamplesAndForeignAnswers) {
  sut_.begin(250, now_, out_);
  sent();

  answer(0x80, "0E0400000000000000003F800000");
  answer(0x01, "04F10600");
  answer(0x0C, "04F10200");

  EXPECT_EQ(sut_.step(), Step::kIdle);
  EXPECT_EQ(sent(), "");
}

TEST_F(MipHostTest, RepeatsACommandAndGivesUpInTheEnd) {
  sut_.begin(250, now_, out_);
  sent();

  for (int i = 1; i < MipHost::kTries; ++i) {
    pass(MipHost::kAnswerWait - std::chrono::milliseconds{1});
    EXPECT_EQ(sent(), "");
    pass(std::chrono::milliseconds{1});
    EXPECT_EQ(sent(), "01:0202");
  }
  EXPECT_EQ(sut_.state(), DialogueState::kUnderWay);
  pass(MipHost::kAnswerWait);

  EXPECT_EQ(sut_.state(), DialogueState::kMute);
}

TEST_F(MipHostTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Bytes idle = from_hex("04F10200");
  const Bytes base_rate = from_hex("04F10E00058E8003E8");

  const std::size_t allocations = support::count_allocations([&] {
    sut_.begin(400, now_, out_);
    sut_.take({0x01, idle}, now_, out_);
    sut_.take({0x0C, base_rate}, now_, out_);
    sut_.advance(now_ + MipHost::kAnswerWait, out_);
  });

  EXPECT_EQ(sut_.step(), Step::kFormat);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::imu
