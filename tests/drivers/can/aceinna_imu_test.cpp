#include "core/base/units.hpp"
#include "drivers/can/aceinna_imu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "made_frames.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::can {
namespace {

using imu::InertialResult;
using std::chrono::microseconds;

constexpr std::uint32_t kForce = 0x08F02D80;
constexpr std::uint32_t kRate = 0x0CF02A80;
/// x, y and z as they stand on the wire.
constexpr AxisMap kAsOnTheWire{{0, 1, 2}, {1.0, 1.0, 1.0}};

/// One line of a trace.
struct Line {
  int at_us;
  std::uint32_t id;
  const char* hex;
};

// Source: imu-can.md, a trace of a real unit.
constexpr Line kTrace[] = {
    {1'373, 0x0CF02980, "C7AA7E5C826B4406"},  {1'629, kForce, "3179557D0A7D8006"},  {1'885, kRate, "C981EB7C79790006"},
    {11'314, 0x0CF02980, "A0AF7E4F816B4406"}, {11'570, kForce, "3279567D0E7D8006"}, {11'869, kRate, "C781EB7C7A790006"},
    {21'809, 0x0CF02980, "7DB47E39806B4406"}, {22'065, kForce, "3179567D0A7D8006"}, {22'364, kRate, "CA81E77C7A790006"},
    {32'049, 0x0CF02980, "5CB97E177F6B4407"}, {32'305, kForce, "2E79567D097D8007"}, {32'603, kRate, "CB81E67C79790007"},
    {33'000, 0x18FF5380, "00040004AAAAAAAA"}};

TEST(AceinnaImu, ReadsTheRealTrace) {
  AceinnaReader sut(kAsOnTheWire);
  std::vector<sensor::ImuReading> readings;
  sensor::ImuReading reading;

  for (const Line& line : kTrace) {
    if (sut.take(frame_of(line.id, line.hex, kBegin + microseconds{line.at_us}), reading)) {
      readings.push_back(reading);
    }
  }

  ASSERT_EQ(readings.size(), 4U);
  EXPECT_LT((readings[0].specific_force_mps2 - Eigen::Vector3d(-9.75, 0.85, 0.10)).norm(), 1e-9);
  EXPECT_LT((readings[0].angular_rate_radps / kDegree - Eigen::Vector3d(9.5703125, -0.1640625, -7.0546875)).norm(), 1e-9);
  EXPECT_EQ(readings[0].received, kBegin + microseconds{1'885});
  EXPECT_EQ(readings[0].device_stamp.time_since_epoch(), (kBegin + microseconds{1'885 - 3'000}).time_since_epoch());
  EXPECT_EQ(readings[3].device_stamp.time_since_epoch(), (kBegin + microseconds{32'603 - 3'500}).time_since_epoch());
  EXPECT_EQ(sut.counters().of(InertialResult::kOther), 5U);
  EXPECT_EQ(sut.counters().of(InertialResult::kIncomplete), 0U);
}

TEST(AceinnaImu, ReadsTheComputedVectorsInBothResolutions) {
  for (const auto& [force, rate] : {std::pair{frame_of(kForce, "0C7DDE7C2B790002"), frame_of(kRate, "807DC07B008C0002")},
                                    {frame_of(0x18FF6D80, "60E883371F56F200"), frame_of(0x18FF6B80, "00EC03F01E001801")}}) {
    AceinnaReader sut(kAsOnTheWire);
    sensor::ImuReading reading;

    EXPECT_FALSE(sut.take(force, reading));
    ASSERT_TRUE(sut.take(rate, reading));

    EXPECT_LT((reading.specific_force_mps2 - Eigen::Vector3d(0.12, -0.34, -9.81)).norm(), 1e-9);
    EXPECT_LT((reading.angular_rate_radps / kDegree - Eigen::Vector3d(1.0, -2.5, 30.0)).norm(), 1e-9);
  }
}

TEST(AceinnaImu, TakesPitchFirstUnlessItIsToldOtherwise) {
  AceinnaReader as_j1939;
  AceinnaReader mapped({{2, 0, 1}, {-1.0, 1.0, 1.0}});
  sensor::ImuReading first;
  sensor::ImuReading second;
  for (const CanFrame& frame : {frame_of(kForce, "0C7DDE7C2B790002"), frame_of(kRate, "807DC07B008C0002")}) {
    as_j1939.take(frame, first);
    mapped.take(frame, second);
  }

  EXPECT_LT((first.specific_force_mps2 - Eigen::Vector3d(-0.34, 0.12, -9.81)).norm(), 1e-9);
  EXPECT_LT((second.specific_force_mps2 - Eigen::Vector3d(9.81, 0.12, -0.34)).norm(), 1e-9);
}

TEST(AceinnaImu, ReadsAxisMapsAsConfigured) {
  const auto as_j1939 = parse_axis_map("y,x,z");
  const auto turned = parse_axis_map("-z,y,-x");

  ASSERT_TRUE(as_j1939 && turned);
  EXPECT_EQ(as_j1939->wire, AxisMap{}.wire);
  EXPECT_EQ(as_j1939->sign, AxisMap{}.sign);
  EXPECT_EQ(turned->wire, (std::array<std::uint8_t, 3>{2, 1, 0}));
  EXPECT_EQ(turned->sign, (std::array{-1.0, 1.0, -1.0}));
  for (const char* none : {"", "y", "y,x", "y,x,y", "y,x,z,", "y,x,z,z", "y;x;z", "Y,X,Z", "--y,x,z", "y,x, z", ",x,z", "-,x,z"}) {
    EXPECT_FALSE(parse_axis_map(none)) << none;
  }
}

TEST(AceinnaImu, GivesUpAHalfWhoseCounterpartDoesNotCome) {
  AceinnaReader sut;
  sensor::ImuReading reading;
  const auto take = [&](std::uint32_t id, int at_ms) {
    return sut.take(frame_of(id, "807DC07B008C0002", kBegin + std::chrono::milliseconds{at_ms}), reading);
  };

  EXPECT_FALSE(take(kForce, 0));
  EXPECT_FALSE(take(kForce, 10));  // in vain: the one before
  EXPECT_FALSE(take(kRate, 20));   // in vain: another one before
  EXPECT_TRUE(take(kForce, 21));

  EXPECT_EQ(sut.counters().of(InertialResult::kIncomplete), 2U);
}

TEST(AceinnaImu, DropsWhatTheDeviceMarksAsAnErrorOrNotAvailable) {
  AceinnaReader sut;
  sensor::ImuReading reading;

  EXPECT_FALSE(sut.take(frame_of(kForce, "00FFDE7C2B790002"), reading));
  EXPECT_FALSE(sut.take(frame_of(kForce, "0C7D00FE2B790002"), reading));
  EXPECT_FALSE(sut.take(frame_of(0x18FF6D80, "FFFF07371F56F200"), reading));

  EXPECT_EQ(sut.counters().of(InertialResult::kIncomplete), 3U);
}

TEST(AceinnaImu, ListensToItsOwnDeviceOnly) {
  AceinnaReader sut(AxisMap{}, std::uint8_t{0x81});
  sensor::ImuReading reading;

  EXPECT_FALSE(sut.take(frame_of(kForce, "0C7DDE7C2B790002"), reading));
  EXPECT_FALSE(sut.take(frame_of(kForce + 1, "0C7DDE7C2B790002"), reading));
  EXPECT_TRUE(sut.take(frame_of(kRate + 1, "807DC07B008C0002"), reading));

  EXPECT_EQ(sut.counters().of(InertialResult::kOther), 1U);
}

TEST(AceinnaImu, RefusesShortFrames) {
  AceinnaReader sut;
  sensor::ImuReading reading;

  EXPECT_FALSE(sut.take(frame_of(kForce, "0C7DDE7C2B7900"), reading));

  EXPECT_EQ(sut.counters().of(InertialResult::kMalformed), 1U);
}

TEST(AceinnaImu, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  AceinnaReader sut;
  sensor::ImuReading reading;
  const CanFrame frames[] = {frame_of(kForce, "0C7DDE7C2B790002"), frame_of(kRate, "807DC07B008C0002")};
  int samples = 0;

  const std::size_t allocations = support::count_allocations([&] {
    for (const CanFrame& frame : frames) {
      samples += sut.take(frame, reading) ? 1 : 0;
    }
  });

  EXPECT_EQ(samples, 1);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::can
