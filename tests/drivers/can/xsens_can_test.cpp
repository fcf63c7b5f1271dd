#include "drivers/can/xsens_can.hpp"

#include <gtest/gtest.h>

#include "made_frames.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::can {
namespace {

using imu::InertialResult;

class XsensCan : public testing::Test {
 protected:
  /// Takes a frame; counts samples.
  bool take(std::uint32_t id, std::string_view hex) {
    const bool is_sample = sut_.take(frame_of(id, hex), reading_);
    samples_ += is_sample ? 1 : 0;
    return is_sample;
  }

  XsensCanReader sut_;
  sensor::ImuReading reading_;
  int samples_ = 0;
};

// The golden vectors of imu-can.md.
TEST_F(XsensCan, ReadsTheGoldenFramesAsOneSample) {
  EXPECT_FALSE(take(0x005, "0314ED53"));
  EXPECT_FALSE(take(0x006, "A986"));
  EXPECT_FALSE(take(0x011, "00000007"));
  EXPECT_FALSE(take(0x032, "0005FFF60100"));
  EXPECT_TRUE(take(0x034, "000DFFE109CF"));

  EXPECT_EQ(reading_.device_stamp.time_since_epoch(), 51'703'123 * std::chrono::microseconds{100});
  EXPECT_EQ(reading_.received, kBegin);
  EXPECT_EQ(reading_.angular_rate_radps, Eigen::Vector3d(0.009765625, -0.01953125, 0.5));
  EXPECT_EQ(reading_.specific_force_mps2, Eigen::Vector3d(0.05078125, -0.12109375, 9.80859375));
  EXPECT_EQ(sut_.counters().of(InertialResult::kSample), 1U);
}

TEST_F(XsensCan, PassesOverTheOtherGoldenFrames) {
  for (const auto& [id, hex] : {std::pair{0x021, "5A82000000005A82"}, {0x022, "00C0FEE02D00"}, {0x007, "1A0B160602041388"},
                                {0x071, "301E075F05C22222"}, {0x076, "0060FFF00000"}, {0x031, "20C5E000753010"}}) {
    EXPECT_FALSE(take(static_cast<std::uint32_t>(id), hex));
  }

  EXPECT_EQ(sut_.counters().of(InertialResult::kOther), 6U);
}

TEST_F(XsensCan, ReadsTheHighRateQuantitiesLikewise) {
  take(0x005, "00000001");
  take(0x062, "000DFFE109CF");

  EXPECT_TRUE(take(0x061, "0005FFF60100"));
}

TEST_F(XsensCan, GivesUpASampleOfWhichAFrameIsMissing) {
  for (int i = 0; i < 3; ++i) {
    take(0x005, "0000000" + std::to_string(i));
    take(0x006, "000" + std::to_string(i));
    take(0x032, "000000000000");
    if (i != 1) {
      take(0x034, "000000000A00");
    }
  }

  EXPECT_EQ(samples_, 2);
  EXPECT_EQ(sut_.counters().of(InertialResult::kIncomplete), 1U);
}

TEST_F(XsensCan, TakesOnlyTheHigherResolutionWhereBothCome) {
  for (int i = 0; i < 4; ++i) {
    take(0x005, "0000000" + std::to_string(i));
    take(0x032, "000000000000");
    take(0x034, "000000000A00");
    take(0x061, "0005FFF60100");
    take(0x062, "000DFFE109CF");
  }

  EXPECT_EQ(samples_, 4);  // the first one is of the lower
  EXPECT_EQ(reading_.angular_rate_radps, Eigen::Vector3d(0.009765625, -0.01953125, 0.5));
  EXPECT_EQ(reading_.device_stamp.time_since_epoch(), 3 * std::chrono::microseconds{100});
  EXPECT_EQ(sut_.counters().of(InertialResult::kIncomplete), 1U);
}

TEST_F(XsensCan, DoesNotGiveASampleTheTimeOfTheNextOne) {
  take(0x032, "000000000000");  // its time was lost
  take(0x034, "000000000A00");

  EXPECT_FALSE(take(0x005, "00000001"));
  EXPECT_FALSE(take(0x032, "0005FFF60100"));
  EXPECT_TRUE(take(0x034, "000DFFE109CF"));

  EXPECT_EQ(reading_.angular_rate_radps, Eigen::Vector3d(0.009765625, -0.01953125, 0.5));
  EXPECT_EQ(sut_.counters().of(InertialResult::kIncomplete), 1U);
}

TEST_F(XsensCan, CountsTheSamplesThatNeverCame) {
  for (const char* counter : {"FFFE", "FFFF", "0002"}) {
    take(0x005, "00000001");
    take(0x006, counter);
    take(0x032, "000000000000");
    take(0x034, "000000000A00");
  }

  EXPECT_EQ(samples_, 3);
  EXPECT_EQ(sut_.counters().missing, 2U);
}

TEST_F(XsensCan, CarriesTheTimeOnOverTheWrapOfItsTicks) {
  const auto sample_at = [&](const char* ticks) {
    take(0x005, ticks);
    take(0x032, "000000000000");
    take(0x034, "000000000A00");
    return reading_.device_stamp;
  };
  const DeviceStamp before = sample_at("FFFFFFF0");

  EXPECT_EQ(sample_at("00000010") - before, std::chrono::microseconds{3200});
}

TEST_F(XsensCan, CountsClippingBeforeAndAfterASampleIsComplete) {
  take(0x011, "00080000");
  take(0x005, "00000001");
  take(0x032, "000000000000");
  take(0x034, "000000000A00");
  take(0x005, "00000002");
  take(0x032, "000000000000");
  take(0x034, "000000000A00");
  take(0x011, "00080000");

  EXPECT_EQ(samples_, 2);
  EXPECT_EQ(sut_.counters().clipped, 2U);
  EXPECT_EQ(sut_.counters().of(InertialResult::kIncomplete), 0U);
}

TEST_F(XsensCan, RefusesFramesOfAnotherLength) {
  EXPECT_FALSE(take(0x005, "0314ED"));
  EXPECT_FALSE(take(0x034, "000DFFE109CF00"));

  EXPECT_EQ(sut_.counters().of(InertialResult::kMalformed), 2U);
}

TEST_F(XsensCan, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const CanFrame frames[] = {frame_of(0x005, "0314ED53"), frame_of(0x032, "0005FFF60100"), frame_of(0x034, "000DFFE109CF")};

  const std::size_t allocations = support::count_allocations([&] {
    for (const CanFrame& frame : frames) {
      samples_ += sut_.take(frame, reading_) ? 1 : 0;
    }
  });

  EXPECT_EQ(samples_, 1);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::can
