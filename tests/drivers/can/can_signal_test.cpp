#include "drivers/can/can_signal.hpp"

#include <gtest/gtest.h>

#include <random>

#include "made_frames.hpp"

namespace slamd::can {
namespace {

TEST(CanSignal, ReadsLittleEndianNumbersFromTheirLowestBit) {
  const CanFrame frame = frame_of(0x201, "34128000FFFF0180");

  EXPECT_EQ(value_of({.id = 0x201, .first_bit = 0, .bits = 16}, frame), 0x1234);
  EXPECT_EQ(value_of({.id = 0x201, .first_bit = 4, .bits = 8}, frame), 0x23);
  EXPECT_EQ(value_of({.id = 0x201, .first_bit = 23, .bits = 1}, frame), 1);
  EXPECT_EQ(value_of({.id = 0x201, .first_bit = 32, .bits = 16, .is_signed = true}, frame), -1);
  EXPECT_EQ(value_of({.id = 0x201, .first_bit = 48, .bits = 16, .is_signed = true}, frame), -32'767);
}

TEST(CanSignal, ReadsBigEndianNumbersFromTheirHighestBit) {
  const CanFrame frame = frame_of(0x201, "123480000FFE0000");

  EXPECT_EQ(value_of({.id = 0x201, .is_big_endian = true, .first_bit = 7, .bits = 16}, frame), 0x1234);
  EXPECT_EQ(value_of({.id = 0x201, .is_big_endian = true, .first_bit = 3, .bits = 8}, frame), 0x23);
  EXPECT_EQ(value_of({.id = 0x201, .is_big_endian = true, .first_bit = 23, .bits = 1}, frame), 1);
  EXPECT_EQ(value_of({.id = 0x201, .is_big_endian = true, .first_bit = 35, .bits = 12, .is_signed = true}, frame), -2);
}

TEST(CanSignal, ScalesAndShifts) {
  const CanSignal speed{.id = 0x0CF00400, .is_extended = true, .first_bit = 24, .bits = 16, .scale = 0.125, .offset = -10.0};

  EXPECT_EQ(value_of(speed, frame_of(0x0CF00400, "0000008002000000")), 0x280 * 0.125 - 10.0);
}

TEST(CanSignal, PassesOverOtherFramesAndShortOnes) {
  const CanSignal sut{.id = 0x201, .first_bit = 8, .bits = 16};
  CanFrame extended = frame_of(0x201, "000102");
  extended.is_extended = true;

  EXPECT_TRUE(value_of(sut, frame_of(0x201, "000102")));
  EXPECT_FALSE(value_of(sut, frame_of(0x201, "0001")));
  EXPECT_FALSE(value_of(sut, frame_of(0x202, "000102")));
  EXPECT_FALSE(value_of(sut, extended));
}

TEST(CanSignal, KnowsWhichBitsLieInAFrame) {
  EXPECT_TRUE((CanSignal{.first_bit = 0, .bits = 64}.is_valid()));
  EXPECT_TRUE((CanSignal{.is_big_endian = true, .first_bit = 7, .bits = 64}.is_valid()));
  EXPECT_TRUE((CanSignal{.is_big_endian = true, .first_bit = 56, .bits = 1}.is_valid()));
  EXPECT_FALSE((CanSignal{.is_big_endian = true, .first_bit = 56, .bits = 2}.is_valid()));
  EXPECT_FALSE((CanSignal{.first_bit = 1, .bits = 64}.is_valid()));
  EXPECT_FALSE((CanSignal{.first_bit = -1}.is_valid()));
  EXPECT_FALSE((CanSignal{.first_bit = 64, .bits = 1}.is_valid()));
  EXPECT_FALSE((CanSignal{.bits = 0}.is_valid()));
}

// Bytes in the other order mirror a signal of whole bytes.
TEST(CanSignal, ReadsTheSameInBothOrdersWhereBytesAreReversed) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    CanFrame frame = frame_of(1, "0000000000000000");
    CanFrame mirrored = frame;
    for (std::size_t i = 0; i < 8; ++i) {
      frame.data[i] = mirrored.data[7 - i] = static_cast<std::byte>(random());
    }
    const int byte = static_cast<int>(random() % 8);
    const int bytes = 1 + static_cast<int>(random() % static_cast<unsigned>(8 - byte));
    const CanSignal little{.id = 1, .first_bit = 8 * byte, .bits = 8 * bytes, .is_signed = true};
    CanSignal big = little;
    big.is_big_endian = true;
    big.first_bit = 8 * (8 - byte - bytes) + 7;

    EXPECT_EQ(value_of(little, frame), value_of(big, mirrored));
  }
}

TEST(CanSignal, ReadsBackWhatWasWrittenAndLeavesTheOtherBits) {
  std::mt19937 random(2);
  for (int round = 0; round < 500; ++round) {
    CanFrame frame = frame_of(1, "0000000000000000");
    for (std::byte& byte : frame.data) {
      byte = static_cast<std::byte>(random());
    }
    CanSignal sut{.id = 1, .is_big_endian = random() % 2 == 0, .first_bit = static_cast<int>(random() % 64),
                  .bits = 1 + static_cast<int>(random() % 50), .is_signed = random() % 2 == 0, .scale = 0.25, .offset = -3.0};
    if (!sut.is_valid()) {
      continue;
    }
    const CanFrame before = frame;
    const double value = value_of(sut, frame).value();

    put_value(sut, value, frame);
    EXPECT_EQ(frame.data, before.data);
    put_value(sut, -3.0, frame);
    EXPECT_EQ(value_of(sut, frame), -3.0);
    put_value(sut, value, frame);
    EXPECT_EQ(frame.data, before.data);
  }
}

TEST(CanSignal, WritesTheNearestNumberThatItCanHold) {
  CanFrame frame = frame_of(1, "0000000000000000");
  const CanSignal is_signed{.id = 1, .bits = 8, .is_signed = true};
  const CanSignal is_long{.id = 1, .bits = 64};

  put_value(is_signed, 1e9, frame);
  EXPECT_EQ(value_of(is_signed, frame), 127.0);
  put_value(is_signed, -1e9, frame);
  EXPECT_EQ(value_of(is_signed, frame), -128.0);
  put_value(is_long, 1e30, frame);
  EXPECT_GT(value_of(is_long, frame), 1.8e19);
}

}  // namespace
}  // namespace slamd::can
