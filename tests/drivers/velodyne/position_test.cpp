#include "drivers/velodyne/position.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::velodyne {
namespace {

using namespace std::chrono_literals;

// The hand-made position packet of the protocol description.
constexpr const char* kSentence = "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A";

std::vector<std::byte> packet_with(const std::string& text,
                                   std::uint8_t pps = 2,
                                   std::uint32_t stamp_us = 140'854'497) {
  std::vector<std::byte> packet(512);
  store_le(packet, 0xC6, stamp_us);
  store_le(packet, 0xCA, pps);
  for (std::size_t i = 0; i < text.size(); ++i) {
    packet[0xCE + i] = static_cast<std::byte>(text[i]);
  }
  return packet;
}

TEST(VelodynePosition, ReadsTheSentenceOfALockedReceiver) {
  Position position;

  ASSERT_EQ(decode_position(packet_with(std::string(kSentence) + "\r\n"), position), PositionResult::kOk);

  EXPECT_EQ(position.device_stamp.time_since_epoch(), 140'854'497us);
  EXPECT_EQ(position.pps, PpsState::kLocked);
  EXPECT_EQ(position.text(), kSentence);
}

TEST(VelodynePosition, TakesAnEmptySentenceForAState) {
  Position position;

  ASSERT_EQ(decode_position(packet_with("", 0), position), PositionResult::kOk);

  EXPECT_EQ(position.pps, PpsState::kNone);
  EXPECT_EQ(position.text(), "");
}

TEST(VelodynePosition, ForgetsWhatThePacketBeforeSaid) {
  Position position;
  ASSERT_EQ(decode_position(packet_with(kSentence), position), PositionResult::kOk);

  ASSERT_EQ(decode_position(packet_with("", 1), position), PositionResult::kOk);

  EXPECT_EQ(position.pps, PpsState::kSynchronising);
  EXPECT_EQ(position.text(), "");
}

TEST(VelodynePosition, TellsEachPpsState) {
  const PpsState states[] = {PpsState::kNone, PpsState::kSynchronising, PpsState::kLocked, PpsState::kError};
  for (int pps = 0; pps < 256; ++pps) {
    Position position;
    ASSERT_EQ(decode_position(packet_with("", static_cast<std::uint8_t>(pps)), position), PositionResult::kOk);
    EXPECT_EQ(position.pps, pps < 4 ? states[pps] : PpsState::kUnknown);
  }
}

TEST(VelodynePosition, RefusesOtherLengthsAndStampsBeyondTheHour) {
  const std::vector<std::byte> good = packet_with(kSentence);
  Position position;
  position.pps = PpsState::kError;

  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_EQ(decode_position(std::span(good).first(size), position), PositionResult::kWrongLength);
  }
  EXPECT_EQ(decode_position(std::vector<std::byte>(513), position), PositionResult::kWrongLength);
  EXPECT_EQ(decode_position(packet_with(kSentence, 2, 3'600'000'000U), position), PositionResult::kBadTimestamp);
  EXPECT_EQ(position.pps, PpsState::kError);  // untouched
  EXPECT_EQ(decode_position(packet_with(kSentence, 2, 3'599'999'999U), position), PositionResult::kOk);
}

TEST(VelodynePosition, ReadsASentenceThatFillsItsField) {
  // No terminator; the field ends after 128 characters, and what comes behind is not of it.
  const std::string whole(128, 'x');
  Position position;

  ASSERT_EQ(decode_position(packet_with(whole + "9999"), position), PositionResult::kOk);

  EXPECT_EQ(position.text(), whole);
}

TEST(VelodynePosition, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const std::vector<std::byte> packet = packet_with(kSentence);
  Position position;

  const std::size_t count = support::count_allocations([&] { decode_position(packet, position); });

  EXPECT_EQ(count, 0U);
  EXPECT_EQ(position.text(), kSentence);
}

}  // namespace
}  // namespace slamd::velodyne
