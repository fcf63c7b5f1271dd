#include "drivers/recording/seconds.hpp"

#include <gtest/gtest.h>

namespace slamd::recording {
namespace {

std::optional<std::int64_t> ns_of(std::string_view word) {
  const auto stamp = parse_seconds(word);
  return stamp ? std::optional(stamp->time_since_epoch().count()) : std::nullopt;
}

TEST(Seconds, KeepEveryNanosecond) {
  EXPECT_EQ(ns_of("1700000000.123456789"), 1'700'000'000'123'456'789);
  EXPECT_EQ(ns_of("1577836980.0991046"), 1'577'836'980'099'104'600);
  EXPECT_EQ(ns_of("0.000000001"), 1);
  EXPECT_EQ(ns_of("12"), 12'000'000'000);
  EXPECT_EQ(ns_of("12."), 12'000'000'000);
}

TEST(Seconds, CutOffWhatIsFinerThanANanosecond) {
  EXPECT_EQ(ns_of("1.9999999999999999999999999"), 1'999'999'999);
}

TEST(Seconds, MayBeNegative) {
  EXPECT_EQ(ns_of("-1.5"), -1'500'000'000);
  EXPECT_EQ(ns_of("-0.25"), -250'000'000);
}

TEST(Seconds, MayHaveAnExponent) {
  EXPECT_EQ(ns_of("1.036224e-01"), 103'622'400);
  EXPECT_EQ(ns_of("2.5E3"), 2'500'000'000'000);
}

TEST(Seconds, AreRefusedWhenTheyAreNone) {
  for (const char* word : {"",
                           ".",
                           ".5",
                           "-",
                           "abc",
                           "1.2.3",
                           "1.2x",
                           "1,5",
                           "nan",
                           "inf",
                           "1e99",
                           "-1e99",
                           "99999999999",
                           "9300000000.0",
                           "1e",
                           "e5",
                           "0x10",
                           "1 2"}) {
    EXPECT_EQ(ns_of(word), std::nullopt) << word;
  }
}

}  // namespace
}  // namespace slamd::recording
