#include "drivers/livox/status_code.hpp"

#include <gtest/gtest.h>

namespace slamd::livox {
namespace {

TEST(StatusCode, ReadsPtpLocked) {
  const StatusCode sut = parse_status_code(0x00006000);

  EXPECT_TRUE(sut.ptp_ok);
  EXPECT_EQ(sut.time_sync, TimeSync::kPtp);
  EXPECT_FALSE(sut.pps_present);
  EXPECT_TRUE(concerns_of(sut).empty());
}

TEST(StatusCode, ReadsGpsWithPpsLocked) {
  const StatusCode sut = parse_status_code(0x00008200);

  EXPECT_TRUE(sut.pps_present);
  EXPECT_EQ(sut.time_sync, TimeSync::kGps);
  EXPECT_TRUE(concerns_of(sut).empty());
}

TEST(StatusCode, NamesTheConcernsOfTheAbnormalPushVector) {
  const StatusCode sut = parse_status_code(0x40000001);

  EXPECT_EQ(sut.temperature, Severity::kWarning);
  EXPECT_EQ(sut.system, Severity::kWarning);
  const auto concerns = concerns_of(sut);
  ASSERT_EQ(concerns.size(), 2U);
  EXPECT_EQ(concerns[0], "temperature high or low");
  EXPECT_EQ(concerns[1], "system warning");
}

TEST(StatusCode, ReadsEachFieldFromItsOwnBits) {
  EXPECT_EQ(parse_status_code(2U << 2).voltage, Severity::kError);
  EXPECT_EQ(parse_status_code(2U << 4).motor, Severity::kError);
  EXPECT_TRUE(parse_status_code(1U << 6).window_dirty);
  EXPECT_TRUE(parse_status_code(1U << 7).window_dirty);
  EXPECT_TRUE(parse_status_code(1U << 8).firmware_error);
  EXPECT_TRUE(parse_status_code(1U << 10).end_of_life_warning);
  EXPECT_TRUE(parse_status_code(1U << 11).fan_warning);
  EXPECT_TRUE(parse_status_code(1U << 12).self_heating);
  EXPECT_EQ(parse_status_code(4U << 14).time_sync, TimeSync::kAbnormal);
  EXPECT_EQ(parse_status_code(7U << 14).time_sync, TimeSync::kReserved);
  EXPECT_EQ(parse_status_code(3U << 30).system, Severity::kReserved);
}

TEST(StatusCode, HasRoomForEveryConcernAtOnce) {
  const StatusCode sut = parse_status_code(0xFFFF'FFFF ^ (3U << 14));  // time sync 4

  EXPECT_EQ(concerns_of(sut).size(), 9U);
}

}  // namespace
}  // namespace slamd::livox
