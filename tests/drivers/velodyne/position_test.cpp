#include "drivers/velodyne/position.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::velodyne {
namespace {

using namespace std::chrono_literals;

// The hand-made position packet of the protocol description.
constexpr const char* kSentence = "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A";
constexpr std::int64_t kSentence_s = 764'426'119;  // 1994-03-23 12:35:19 UTC

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

/// Frames what stands between $ and * with its checksum.
std::string with_checksum(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) {
    sum ^= static_cast<unsigned char>(c);
  }
  char tail[4];
  std::snprintf(tail, sizeof tail, "*%02X", sum & 0xFFU);
  return "$" + body + tail;
}

TEST(VelodynePosition, ReadsTheSentenceOfALockedReceiver) {
  Position position;

  ASSERT_EQ(decode_position(packet_with(std::string(kSentence) + "\r\n"), position), PositionResult::kOk);

  EXPECT_EQ(position.device_stamp.time_since_epoch(), 140'854'497us);
  EXPECT_EQ(position.pps, PpsState::kLocked);
  EXPECT_TRUE(position.has_sentence);
  EXPECT_TRUE(position.sentence_good);
  ASSERT_TRUE(position.rmc);
  EXPECT_TRUE(position.rmc->valid);
  EXPECT_EQ(position.rmc->unix_seconds, kSentence_s);
  EXPECT_NEAR(position.rmc->latitude_deg, 48.0 + 7.038 / 60.0, 1e-9);
  EXPECT_NEAR(position.rmc->longitude_deg, 11.0 + 31.0 / 60.0, 1e-9);
  EXPECT_NEAR(position.rmc->speed_mps, 22.4 * 0.514444, 1e-3);
  EXPECT_NEAR(position.rmc->course_deg, 84.4, 1e-9);
}

TEST(VelodynePosition, TakesAnEmptySentenceForAState) {
  Position position;

  ASSERT_EQ(decode_position(packet_with("", 0), position), PositionResult::kOk);

  EXPECT_EQ(position.pps, PpsState::kNone);
  EXPECT_FALSE(position.has_sentence);
  EXPECT_FALSE(position.sentence_good);
  EXPECT_FALSE(position.rmc);
}

TEST(VelodynePosition, ForgetsWhatThePacketBeforeSaid) {
  Position position;
  ASSERT_EQ(decode_position(packet_with(kSentence), position), PositionResult::kOk);

  ASSERT_EQ(decode_position(packet_with("", 1), position), PositionResult::kOk);

  EXPECT_EQ(position.pps, PpsState::kSynchronising);
  EXPECT_FALSE(position.has_sentence);
  EXPECT_FALSE(position.rmc);
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

TEST(VelodynePosition, MarksASentenceWithAWrongChecksum) {
  std::string wrong = kSentence;
  wrong[8] = '3';
  Position position;

  ASSERT_EQ(decode_position(packet_with(wrong), position), PositionResult::kOk);

  EXPECT_TRUE(position.has_sentence);
  EXPECT_FALSE(position.sentence_good);
  EXPECT_FALSE(position.rmc);
}

TEST(VelodynePosition, ReadsASentenceThatFillsItsField) {
  // No terminator; the field ends after 128 characters, and what comes behind is not of it.
  std::string body = "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W,";
  body.append(128 - 4 - body.size(), 'x');
  const std::string whole = with_checksum(body);
  ASSERT_EQ(whole.size(), 128U);
  Position position;

  ASSERT_EQ(decode_position(packet_with(whole + "9999"), position), PositionResult::kOk);

  EXPECT_TRUE(position.sentence_good);
  EXPECT_TRUE(position.rmc);
}

TEST(VelodynePosition, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const std::vector<std::byte> packet = packet_with(kSentence);
  Position position;

  const std::size_t count = support::count_allocations([&] { decode_position(packet, position); });

  EXPECT_EQ(count, 0U);
  EXPECT_TRUE(position.rmc);
}

TEST(VelodyneRmc, PutsSouthAndWestBelowZero) {
  const auto rmc = parse_rmc(with_checksum("GNRMC,000000.00,A,3345.5000,S,07030.0000,W,0.0,,010126,,,A"));

  ASSERT_TRUE(rmc);
  EXPECT_NEAR(rmc->latitude_deg, -(33.0 + 45.5 / 60.0), 1e-9);
  EXPECT_NEAR(rmc->longitude_deg, -70.5, 1e-9);
  EXPECT_EQ(rmc->unix_seconds, 1'767'225'600);  // 2026-01-01 00:00:00 UTC
  EXPECT_EQ(rmc->course_deg, 0.0);
}

TEST(VelodyneRmc, KeepsTheTimeOfAReceiverWithoutAFix) {
  const auto rmc = parse_rmc(with_checksum("GPRMC,235960,V,,,,,,,311216,,"));

  ASSERT_TRUE(rmc);
  EXPECT_FALSE(rmc->valid);
  EXPECT_EQ(rmc->unix_seconds, 1'483'228'800);  // the leap second ends the day
}

TEST(VelodyneRmc, TakesYearsFromEightyOnForTheLastCentury) {
  const auto late = parse_rmc(with_checksum("GPRMC,000000,V,,,,,,,010179,,"));
  const auto early = parse_rmc(with_checksum("GPRMC,000000,V,,,,,,,010180,,"));

  ASSERT_TRUE(late && early);
  EXPECT_EQ(late->unix_seconds, 3'439'756'800);  // 2079-01-01
  EXPECT_EQ(early->unix_seconds, 315'532'800);   // 1980-01-01
}

TEST(VelodyneRmc, RefusesWhatIsNoRmc) {
  for (const char* body : {"GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
                           "GPRMC",
                           "GPRMC,123519,A,4807.038,N",
                           "GPRMC,,V,,,,,,,,,",
                           "GPRMC,243519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,126019,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,123561,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,1235,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,310294,003.1,W",
                           "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,231394,003.1,W",
                           "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,000094,003.1,W",
                           "GPRMC,1x3519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W"}) {
    EXPECT_FALSE(parse_rmc(with_checksum(body))) << body;
  }
  EXPECT_FALSE(parse_rmc(""));
  EXPECT_FALSE(parse_rmc("$"));
  EXPECT_FALSE(parse_rmc("*00"));
}

TEST(VelodyneRmc, HoldsNoPositionThatCannotBe) {
  for (const char* place : {"9100.000,N,01131.000,E", "4807.038,N,18100.000,E", "1e300,N,01131.000,E", "inf,N,nan,E",
                            "-4807.038,N,01131.000,E", "9000.001,N,01131.000,E", ",N,01131.000,E", "4807,N,x,E"}) {
    const auto rmc = parse_rmc(with_checksum("GPRMC,123519,A," + std::string(place) + ",022.4,084.4,230394,003.1,W"));

    ASSERT_TRUE(rmc) << place;  // the time is good
    EXPECT_FALSE(rmc->valid) << place;
    EXPECT_EQ(rmc->unix_seconds, kSentence_s) << place;
  }
}

TEST(VelodyneRmc, ChecksTheChecksumWhateverItsCase) {
  EXPECT_TRUE(nmea_checksum_holds(kSentence));
  EXPECT_TRUE(nmea_checksum_holds("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6a"));
  EXPECT_FALSE(nmea_checksum_holds("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6B"));
  EXPECT_FALSE(nmea_checksum_holds("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6"));
  EXPECT_FALSE(nmea_checksum_holds("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*"));
  EXPECT_FALSE(nmea_checksum_holds("GPRMC,123519*00"));
  EXPECT_FALSE(nmea_checksum_holds(""));
}

TEST(VelodyneRmc, SurvivesAnyMutation) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const std::string sentence = kSentence;
    std::string body = sentence.substr(1, sentence.size() - 4);
    for (std::size_t i = random() % 6; i > 0; --i) {
      body[6 + random() % (body.size() - 6)] = "0123456789.,-eEnNiIfFaASW"[random() % 25];
    }

    const auto rmc = parse_rmc(with_checksum(body));

    if (rmc) {
      RC_ASSERT(std::abs(rmc->latitude_deg) <= 90.0);
      RC_ASSERT(std::abs(rmc->longitude_deg) <= 180.0);
      RC_ASSERT(std::isfinite(rmc->speed_mps) && std::isfinite(rmc->course_deg));
    }
  }));
}

}  // namespace
}  // namespace slamd::velodyne
