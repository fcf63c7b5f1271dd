#include "drivers/transport/host_clock.hpp"

#include <gtest/gtest.h>

namespace slamd::transport {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::seconds;

/// Clocks that a test turns by hand.
ClockReadings hand_clocks;

ClockReadings read_hand_clocks() { return hand_clocks; }

class HostClockByHand : public testing::Test {
 protected:
  HostClockByHand() { hand_clocks = {seconds(100), hours(500'000)}; }

  static void pass(Duration time) {
    hand_clocks.monotonic += time;
    hand_clocks.realtime += time;
  }
};

TEST_F(HostClockByHand, ShowsUnixTimeAtItsConstruction) {
  const HostClock sut(&read_hand_clocks);

  EXPECT_EQ(sut.now(), Stamp{} + hours(500'000));
}

TEST_F(HostClockByHand, RunsWithTheMonotonicClockWhereverTheWallClockSteps) {
  const HostClock sut(&read_hand_clocks);
  const Stamp begin = sut.now();

  pass(seconds(5));
  hand_clocks.realtime -= hours(2);

  EXPECT_EQ(sut.now() - begin, seconds(5));
}

TEST_F(HostClockByHand, ConvertsWallClockStampsByTheDifferenceOfTheMoment) {
  const HostClock sut(&read_hand_clocks);
  pass(seconds(5));
  const Stamp before_step = sut.from_realtime(hand_clocks.realtime, sut.read());

  hand_clocks.realtime += hours(3);
  pass(seconds(1));
  const Stamp after_step = sut.from_realtime(hand_clocks.realtime - microseconds(40), sut.read());

  EXPECT_EQ(before_step, Stamp{} + hours(500'000) + seconds(5));
  EXPECT_EQ(after_step - before_step, seconds(1) - microseconds(40));
}

TEST_F(HostClockByHand, TellsTheMonotonicTimeOfAStamp) {
  const HostClock sut(&read_hand_clocks);

  EXPECT_EQ(sut.monotonic_of(sut.now() + seconds(2)), seconds(102));
  EXPECT_EQ(sut.from_monotonic(seconds(102)), sut.now() + seconds(2));
}

TEST(ReadClocks, AgreesWithTheClocksOfTheHost) {
  const auto before = std::chrono::steady_clock::now().time_since_epoch();
  const ClockReadings sut = read_clocks();
  const auto after = std::chrono::steady_clock::now().time_since_epoch();
  const auto realtime = std::chrono::system_clock::now().time_since_epoch();

  EXPECT_GE(sut.monotonic, before);
  EXPECT_LE(sut.monotonic, after);
  EXPECT_LT(realtime - sut.realtime, seconds(5));
  EXPECT_GE(realtime - sut.realtime, Duration(0));
}

}  // namespace
}  // namespace slamd::transport
