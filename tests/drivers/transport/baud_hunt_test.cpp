#include "drivers/transport/baud_hunt.hpp"

#include <gtest/gtest.h>

#include <set>

namespace slamd::transport {
namespace {

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};
constexpr Duration kMoment = std::chrono::milliseconds{1};

TEST(BaudHunt, StaysAtARateWhereGoodFramesCome) {
  BaudHunt sut;
  sut.begin(kBegin);
  const int baud = sut.baud();

  sut.hear(kBegin + 10 * kMoment);
  EXPECT_FALSE(sut.found());
  sut.hear(kBegin + 20 * kMoment);

  EXPECT_TRUE(sut.found());
  EXPECT_FALSE(sut.advance(kBegin + 100 * BaudHunt::kDwell));
  EXPECT_EQ(sut.baud(), baud);
}

TEST(BaudHunt, TriesEachRateOnceInARound) {
  BaudHunt sut;
  sut.begin(kBegin);
  std::set<int> tried{sut.baud()};
  Stamp now = kBegin;

  while (sut.rounds() == 0) {
    now += BaudHunt::kDwell;
    EXPECT_FALSE(sut.advance(now - kMoment));
    EXPECT_TRUE(sut.advance(now));
    tried.insert(sut.baud());
  }

  EXPECT_EQ(tried, std::set<int>(BaudHunt::kRates.begin(), BaudHunt::kRates.end()));
}

TEST(BaudHunt, WaitsLongerWhereOneGoodFrameCame) {
  BaudHunt sut;
  sut.begin(kBegin);

  sut.hear(kBegin + BaudHunt::kDwell - kMoment);

  EXPECT_FALSE(sut.advance(kBegin + BaudHunt::kDwell));
  EXPECT_TRUE(sut.advance(kBegin + 2 * BaudHunt::kDwell));
  EXPECT_FALSE(sut.found());
}

TEST(BaudHunt, ProbesASilentRateOnce) {
  BaudHunt sut;
  sut.begin(kBegin);

  EXPECT_FALSE(sut.take_probe(kBegin + BaudHunt::kProbeAfter - kMoment));
  EXPECT_TRUE(sut.take_probe(kBegin + BaudHunt::kProbeAfter));
  EXPECT_FALSE(sut.take_probe(kBegin + BaudHunt::kProbeAfter + kMoment));

  sut.advance(kBegin + BaudHunt::kDwell);
  EXPECT_TRUE(sut.take_probe(kBegin + BaudHunt::kDwell + BaudHunt::kProbeAfter));
  sut.hear_answer();
  EXPECT_TRUE(sut.found());
}

TEST(BaudHunt, ProbesNoRateAtWhichSomethingIsHeard) {
  BaudHunt sut;
  sut.begin(kBegin);

  sut.hear(kBegin);

  EXPECT_FALSE(sut.take_probe(kBegin + BaudHunt::kProbeAfter));
}

TEST(BaudHunt, BeginsAgainWithTheLastGoodRate) {
  BaudHunt sut;
  sut.begin(kBegin);
  sut.advance(kBegin + BaudHunt::kDwell);
  sut.hear_answer();
  const int good = sut.baud();

  sut.begin(kBegin + std::chrono::hours{1});

  EXPECT_EQ(sut.baud(), good);
  EXPECT_FALSE(sut.found());
}

}  // namespace
}  // namespace slamd::transport
