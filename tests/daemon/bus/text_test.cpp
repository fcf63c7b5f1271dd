#include "daemon/bus/text.hpp"

#include <gtest/gtest.h>

namespace slamd::bus {
namespace {

TEST(Text, KeepsWhatFits) {
  const Text<5> sut("abcde");

  EXPECT_EQ(sut.view(), "abcde");
}

TEST(Text, CutsWhatDoesNot) {
  const Text<5> sut("abcdef");

  EXPECT_EQ(sut.view(), "abcde");
}

TEST(Text, CutsBeforeACharacterThatDoesNotFitWhole) {
  const Text<5> sut("abcdü");  // ü: two bytes

  EXPECT_EQ(sut.view(), "abcd");
}

TEST(Text, ForgetsALongerTextBefore) {
  Text<5> sut("abcde");

  sut = "xy";

  EXPECT_EQ(sut.view(), "xy");
}

}  // namespace
}  // namespace slamd::bus
