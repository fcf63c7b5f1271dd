#include "drivers/can/wheel_signals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/assert.hpp"
#include "made_frames.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::can {
namespace {

using std::chrono::milliseconds;

constexpr double kTrack_m = 0.6;

/// mm/s, as signed words of 16 bits.
CanSignal speed_at(std::uint32_t id, int first_bit) {
  return {.id = id, .first_bit = first_bit, .is_signed = true, .scale = 0.001};
}

WheelSignals in_one_frame() { return {WheelModel::kDifferential, {speed_at(0x1A0, 0), speed_at(0x1A0, 16)}, kTrack_m}; }
WheelSignals in_two_frames() { return {WheelModel::kDifferential, {speed_at(0x1A0, 0), speed_at(0x1A1, 0)}, kTrack_m}; }

/// km/h in hundredths, and tenths of a degree, highest byte first.
WheelSignals of_a_car() {
  const CanSignal speed{.id = 0x0CFE6CEE, .is_extended = true, .is_big_endian = true, .first_bit = 7, .scale = 0.01 / 3.6};
  const CanSignal angle{.id = 0x2B0, .is_big_endian = true, .first_bit = 7, .is_signed = true, .scale = 0.1 * M_PI / 180.0};
  return {WheelModel::kAckermann, {speed, angle}, 2.5};
}

TEST(WheelSignals, TakesBothSpeedsFromOneFrame) {
  WheelReader sut(in_one_frame());
  sensor::WheelSample sample;

  ASSERT_TRUE(sut.take(frame_of(0x1A0, "E803DC05"), sample));  // 1000 and 1500 mm/s

  EXPECT_EQ(sample.stamp, kBegin);
  EXPECT_DOUBLE_EQ(sample.speed_mps, 1.25);
  EXPECT_NEAR(sample.turn_rate_radps, 0.5 / kTrack_m, 1e-12);
  EXPECT_EQ(sut.of(WheelResult::kSample), 1U);
}

TEST(WheelSignals, TakesBothSpeedsFromTwoFramesWhicheverComesFirst) {
  WheelReader sut(in_two_frames());
  sensor::WheelSample sample;

  EXPECT_FALSE(sut.take(frame_of(0x1A0, "E803"), sample));
  EXPECT_TRUE(sut.take(frame_of(0x1A1, "18FC", kBegin + milliseconds{1}), sample));  // −1000 mm/s
  EXPECT_EQ(sample.stamp, kBegin + milliseconds{1});
  EXPECT_DOUBLE_EQ(sample.speed_mps, 0.0);
  EXPECT_NEAR(sample.turn_rate_radps, -2.0 / kTrack_m, 1e-12);
  EXPECT_FALSE(sut.take(frame_of(0x1A1, "E803", kBegin + milliseconds{20}), sample));
  EXPECT_TRUE(sut.take(frame_of(0x1A0, "E803", kBegin + milliseconds{21}), sample));

  EXPECT_EQ(sut.of(WheelResult::kSample), 2U);
  EXPECT_EQ(sut.of(WheelResult::kIncomplete), 0U);
}

TEST(WheelSignals, MakesNoSampleOfSpeedsOfDifferentTimes) {
  WheelReader sut(in_two_frames());
  sensor::WheelSample sample;

  EXPECT_FALSE(sut.take(frame_of(0x1A0, "E803"), sample));
  EXPECT_FALSE(sut.take(frame_of(0x1A0, "E803", kBegin + milliseconds{20}), sample));  // the first one was in vain
  EXPECT_FALSE(sut.take(frame_of(0x1A1, "E803", kBegin + milliseconds{40}), sample));  // and the second
  EXPECT_TRUE(sut.take(frame_of(0x1A0, "E803", kBegin + milliseconds{41}), sample));

  EXPECT_EQ(sut.of(WheelResult::kIncomplete), 2U);
}

TEST(WheelSignals, SteersAnAckermannVehicleByItsLastAngle) {
  WheelReader sut(of_a_car());
  sensor::WheelSample sample;
  const auto angle = [&](Stamp at) { return sut.take(frame_of(0x2B0, "0064", at), sample); };      // 10°
  const auto speed = [&](Stamp at) { return sut.take(frame_of(0x0CFE6CEE, "0708", at), sample); };  // 18 km/h

  EXPECT_FALSE(speed(kBegin));  // no angle yet
  EXPECT_FALSE(angle(kBegin + milliseconds{5}));
  EXPECT_TRUE(speed(kBegin + milliseconds{20}));
  EXPECT_TRUE(speed(kBegin + milliseconds{40}));
  EXPECT_NEAR(sample.speed_mps, 5.0, 1e-12);
  EXPECT_NEAR(sample.turn_rate_radps, 5.0 * std::tan(10.0 * M_PI / 180.0) / 2.5, 1e-12);
  EXPECT_FALSE(speed(kBegin + milliseconds{400}));  // the angle is too old

  EXPECT_EQ(sut.of(WheelResult::kSample), 2U);
}

TEST(WheelSignals, CountsWhatIsNoSample) {
  WheelReader sut(in_one_frame());
  WheelReader car(of_a_car());
  sensor::WheelSample sample;

  EXPECT_FALSE(sut.take(frame_of(0x1A1, "E803DC05"), sample));
  EXPECT_FALSE(sut.take(frame_of(0x1A0, "E803DC"), sample));
  EXPECT_FALSE(sut.take(frame_of(0x1A0, "0080FF7F"), sample));  // −32.8 and 32.8 m/s: 109 rad/s
  EXPECT_FALSE(car.take(frame_of(0x2B0, "0384"), sample));      // 90°
  EXPECT_FALSE(car.take(frame_of(0x0CFE6CEE, "0000"), sample));

  EXPECT_EQ(sut.of(WheelResult::kOther), 1U);
  EXPECT_EQ(sut.of(WheelResult::kMalformed), 1U);
  EXPECT_EQ(sut.of(WheelResult::kOutOfRange), 1U);
  EXPECT_EQ(car.of(WheelResult::kOutOfRange), 1U);
}

TEST(WheelSignals, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  WheelReader sut(in_one_frame());
  const CanFrame frame = frame_of(0x1A0, "E803DC05");
  sensor::WheelSample sample;

  const auto allocations = support::count_allocations([&] { sut.take(frame, sample); });

  EXPECT_EQ(sut.of(WheelResult::kSample), 1U);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::can
