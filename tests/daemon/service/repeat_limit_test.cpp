#include "daemon/service/repeat_limit.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace slamd::service {
namespace {

using std::chrono::seconds;

Stamp at(int s) { return Stamp{} + seconds(s); }

std::vector<std::string> told(RepeatLimit& sut, Stamp now, bool all = false) {
  std::vector<std::string> messages;
  sut.tell(now, all, [&](const std::string& message, std::uint64_t more) { messages.push_back(message + " +" + std::to_string(more)); });
  return messages;
}

TEST(RepeatLimit, SaysTheFirstAtOnceAndThenHowManyMoreAndTheLast) {
  RepeatLimit sut(seconds(5));

  EXPECT_TRUE(sut.admit("a", "a 1", at(0)));
  EXPECT_FALSE(sut.admit("a", "a 2", at(1)));
  EXPECT_FALSE(sut.admit("a", "a 3", at(4)));

  EXPECT_TRUE(told(sut, at(4)).empty());
  EXPECT_EQ(told(sut, at(5)), std::vector<std::string>{"a 3 +2"});
  EXPECT_TRUE(told(sut, at(6)).empty());
}

TEST(RepeatLimit, GoesOnCountingWhileItIsNotQuiet) {
  RepeatLimit sut(seconds(5));
  sut.admit("a", "a 1", at(0));
  sut.admit("a", "a 2", at(1));
  told(sut, at(5));

  EXPECT_FALSE(sut.admit("a", "a 3", at(6)));
  EXPECT_EQ(told(sut, at(10)), std::vector<std::string>{"a 3 +1"});
}

TEST(RepeatLimit, TakesAMessageAfterAQuietPeriodForNews) {
  RepeatLimit sut(seconds(5));
  sut.admit("a", "a 1", at(0));
  told(sut, at(5));

  EXPECT_TRUE(sut.admit("a", "a 2", at(6)));
}

TEST(RepeatLimit, LimitsEachCauseApart) {
  RepeatLimit sut(seconds(5));
  sut.admit("a", "a 1", at(0));

  EXPECT_TRUE(sut.admit("b", "b 1", at(0)));
}

TEST(RepeatLimit, LosesNothingAtTheEnd) {
  RepeatLimit sut(seconds(5));
  sut.admit("a", "a 1", at(0));
  sut.admit("a", "a 2", at(1));

  EXPECT_EQ(told(sut, at(2), true), std::vector<std::string>{"a 2 +1"});
}

TEST(RepeatLimit, SaysAllWithoutAPeriod) {
  RepeatLimit sut(Duration::zero());

  EXPECT_TRUE(sut.admit("a", "a 1", at(0)));
  EXPECT_TRUE(sut.admit("a", "a 2", at(0)));
}

}  // namespace
}  // namespace slamd::service
