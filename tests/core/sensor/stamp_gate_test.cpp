#include "core/sensor/stamp_gate.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace slamd::sensor {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Stamp kGateBegin{hours{400'000}};

/// A gate that has seen a second of stamps, 5 ms apart; the next one is due at kGateBegin + 1 s.
StampGate after_a_second() {
  StampGate gate(milliseconds{250});
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(gate.judge(kGateBegin + i * milliseconds{5}), StampVerdict::kInOrder);
  }
  return gate;
}

Stamp due(int i) { return kGateBegin + milliseconds{1000 + 5 * i}; }

TEST(StampGate, OneWildStampChangesNothing) {
  for (const Duration wild : {Duration{hours{1}}, Duration{milliseconds{300}}, Duration{-hours{1}}, Duration{-milliseconds{300}}}) {
    StampGate sut = after_a_second();

    EXPECT_EQ(sut.judge(due(0) + wild), wild > Duration{} ? StampVerdict::kAhead : StampVerdict::kOld);
    for (int i = 1; i < 200; ++i) {
      EXPECT_EQ(sut.judge(due(i)), StampVerdict::kInOrder);
    }
  }
}

TEST(StampGate, GapIsEnteredByItsSecondStamp) {
  StampGate sut = after_a_second();

  EXPECT_EQ(sut.judge(due(1000)), StampVerdict::kAhead);
  EXPECT_EQ(sut.judge(due(1000)), StampVerdict::kAhead);
  EXPECT_EQ(sut.judge(due(1001)), StampVerdict::kInOrder);
  EXPECT_EQ(sut.judge(due(1002)), StampVerdict::kInOrder);
}

TEST(StampGate, FirstStampCanBeMadeToWaitForASecond) {
  StampGate sut(milliseconds{250}, StampGate::First::kMustBeConfirmed);

  EXPECT_EQ(sut.judge(kGateBegin + hours{1}), StampVerdict::kAhead);
  EXPECT_EQ(sut.judge(kGateBegin), StampVerdict::kAhead);
  EXPECT_EQ(sut.judge(kGateBegin + milliseconds{5}), StampVerdict::kInOrder);
}

TEST(StampGate, SlowSourceIsNotHeldBackForEver) {
  StampGate sut(milliseconds{250});
  int in_order = 0;
  for (int i = 0; i < 100; ++i) {
    in_order += sut.judge(kGateBegin + i * milliseconds{400}) == StampVerdict::kInOrder ? 1 : 0;
  }

  EXPECT_GE(in_order, 50);
}

TEST(StampGate, BeginsAnewAfterAQuarterOfASecondOfOldStampsInOrder) {
  for (const bool first_was_wild : {true, false}) {
    StampGate sut = first_was_wild ? StampGate(milliseconds{250}) : after_a_second();
    const Stamp begin = first_was_wild ? kGateBegin : kGateBegin - hours{2};
    if (first_was_wild) {
      EXPECT_EQ(sut.judge(kGateBegin + hours{5}), StampVerdict::kInOrder);
    }
    int i = 0;
    while (i < 200 && sut.judge(begin + i * milliseconds{5}) == StampVerdict::kOld) {
      ++i;
    }

    EXPECT_EQ(i, 51);
    EXPECT_EQ(sut.judge(begin + (i + 1) * milliseconds{5}), StampVerdict::kInOrder);
  }
}

TEST(StampGate, SlowSourceIsFollowedWhenItsClockGoesBack) {
  StampGate sut = after_a_second();
  int old = 0;
  while (old < 20 && sut.judge(kGateBegin - hours{1} + old * seconds{1}) == StampVerdict::kOld) {
    ++old;
  }

  EXPECT_EQ(old, 4);
}

TEST(StampGate, RepeatedAndLateStampsBetweenGoodOnesNeverStepBack) {
  StampGate sut = after_a_second();

  for (int i = 0; i < 400; ++i) {
    EXPECT_EQ(sut.judge(due(i)), StampVerdict::kInOrder);
    EXPECT_EQ(sut.judge(due(i - 40)), StampVerdict::kOld);
  }
}

TEST(StampGate, SurvivesTheEndsOf64Bits) {
  StampGate sut = after_a_second();
  constexpr Stamp kLast{Duration{std::numeric_limits<std::int64_t>::max()}};
  constexpr Stamp kFirst{Duration{std::numeric_limits<std::int64_t>::min()}};

  EXPECT_EQ(sut.judge(kLast), StampVerdict::kAhead);
  EXPECT_EQ(sut.judge(kFirst), StampVerdict::kOld);
  EXPECT_EQ(sut.judge(kLast), StampVerdict::kAhead);
  EXPECT_EQ(sut.judge(due(0)), StampVerdict::kInOrder);
}

}  // namespace
}  // namespace slamd::sensor
