#include "daemon/devices/utc_feed.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace slamd::devices {
namespace {

using namespace std::chrono_literals;

constexpr Stamp kHeard{1000s};
constexpr sensor::UtcStamp kUtc{1'774'260'672s};  // 2026-03-23 10:11:12

sensor::GnssFix fix_at(sensor::UtcStamp utc, Stamp heard = kHeard) {
  sensor::GnssFix fix;
  fix.stamp = heard;
  fix.utc = utc;
  fix.quality = sensor::FixQuality::kSingle;
  return fix;
}

TEST(UtcFeed, NamesTheSecondThatTheReceiverNames) {
  UtcFeed sut;

  EXPECT_EQ(sut.due(fix_at(kUtc), kHeard + 50ms),
            (livox::Sdk1Utc{.year = 2026, .month = 3, .day = 23, .hour = 10, .in_hour_us = 672'000'000}));
}

TEST(UtcFeed, NamesEachSecondOnce) {
  UtcFeed sut;

  EXPECT_TRUE(sut.due(fix_at(kUtc), kHeard));
  EXPECT_FALSE(sut.due(fix_at(kUtc), kHeard + 100ms));
  EXPECT_TRUE(sut.due(fix_at(kUtc + 1s, kHeard + 1s), kHeard + 1s));
}

TEST(UtcFeed, PassesOverFixesBetweenTheEdges) {
  UtcFeed sut;

  EXPECT_FALSE(sut.due(fix_at(kUtc + 200ms), kHeard));
  EXPECT_FALSE(sut.due(fix_at(kUtc + 995ms - 1ns), kHeard));
  EXPECT_TRUE(sut.due(fix_at(kUtc - 350us), kHeard));  // as NAV-PVT has it
  EXPECT_FALSE(sut.due(fix_at(kUtc + 350us), kHeard));
}

TEST(UtcFeed, IsSilentWhenTheNextEdgeIsNearOrThereIsNoFix) {
  UtcFeed sut;
  sensor::GnssFix none = fix_at(kUtc);
  none.quality = sensor::FixQuality::kNone;
  sensor::GnssFix undated = fix_at(kUtc);
  undated.utc.reset();

  EXPECT_FALSE(sut.due(none, kHeard));
  EXPECT_FALSE(sut.due(undated, kHeard));
  EXPECT_FALSE(sut.due(fix_at(kUtc), kHeard + UtcFeed::kNewest + 1ns));
  EXPECT_FALSE(sut.due(sensor::GnssFix{}, kHeard));
  EXPECT_TRUE(sut.due(fix_at(kUtc), kHeard + UtcFeed::kNewest));
}

TEST(UtcFeed, BeginsHoursAndDaysAnew) {
  UtcFeed sut;

  EXPECT_EQ(sut.due(fix_at(sensor::UtcStamp(1'767'225'600s)), kHeard),
            (livox::Sdk1Utc{.year = 2026, .month = 1, .day = 1, .hour = 0, .in_hour_us = 0}));
  EXPECT_EQ(sut.due(fix_at(sensor::UtcStamp(1'767'225'599s)), kHeard),
            (livox::Sdk1Utc{.year = 2025, .month = 12, .day = 31, .hour = 23, .in_hour_us = 3'599'000'000}));
  EXPECT_FALSE(sut.due(fix_at(sensor::UtcStamp(900'000'000s)), kHeard));  // 1998
}

}  // namespace
}  // namespace slamd::devices
