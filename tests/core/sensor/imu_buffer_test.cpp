#include "core/sensor/imu_buffer.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/allocation_guard.hpp"

namespace slamd::sensor {
namespace {

using std::chrono::milliseconds;

Stamp at_ms(std::int64_t ms) {
  return Stamp{milliseconds{ms}};
}

ImuSample sample_at(std::int64_t ms) {
  ImuSample sample;
  sample.stamp = at_ms(ms);
  sample.angular_rate_radps.x() = static_cast<double>(ms) * 0.01;
  sample.specific_force_mps2.z() = 9.81;
  return sample;
}

ImuBuffer filled(std::size_t capacity, int samples) {
  ImuBufferConfig config;
  config.capacity = capacity;
  ImuBuffer buffer(config);
  for (int i = 0; i < samples; ++i) {
    EXPECT_TRUE(buffer.push(sample_at(5 * i)));
  }
  return buffer;
}

TEST(ImuBuffer, KeepsSamplesInTimeOrder) {
  const ImuBuffer sut = filled(8, 5);

  EXPECT_EQ(sut.size(), 5U);
  EXPECT_EQ(sut.oldest().stamp, at_ms(0));
  EXPECT_EQ(sut.newest().stamp, at_ms(20));
  EXPECT_EQ(sut.counts().accepted, 5U);
}

TEST(ImuBuffer, RefusesWhatIsNotNewerAndCountsItByReason) {
  ImuBuffer sut = filled(8, 3);

  EXPECT_FALSE(sut.push(sample_at(10)));
  EXPECT_FALSE(sut.push(sample_at(9)));
  EXPECT_FALSE(sut.push(sample_at(0)));

  EXPECT_EQ(sut.counts().refused_for(ImuRefusal::kDuplicate), 1U);
  EXPECT_EQ(sut.counts().refused_for(ImuRefusal::kOutOfOrder), 2U);
  EXPECT_EQ(sut.size(), 3U);
}

TEST(ImuBuffer, OneWildStampIsRefusedAndTheNextSamplesAreTaken) {
  ImuBuffer sut = filled(8, 3);

  EXPECT_FALSE(sut.push(sample_at(3'600)));
  EXPECT_TRUE(sut.push(sample_at(15)));

  EXPECT_EQ(sut.counts().refused_for(ImuRefusal::kFarAhead), 1U);
  EXPECT_EQ(sut.newest().stamp, at_ms(15));
}

TEST(ImuBuffer, BeginsAnewAfterAWildFirstStamp) {
  ImuBuffer sut(ImuBufferConfig{});
  sut.push(sample_at(3'600));

  for (int i = 0; i < 100; ++i) {
    sut.push(sample_at(5 * i));
  }

  EXPECT_EQ(sut.counts().restarts, 1U);
  EXPECT_EQ(sut.newest().stamp, at_ms(495));
  EXPECT_EQ(sut.oldest().stamp, at_ms(255));
}

TEST(ImuBuffer, RefusesWhatIsNotFiniteOrImplausible) {
  ImuBuffer sut = filled(8, 1);
  ImuSample not_finite = sample_at(5);
  not_finite.specific_force_mps2.y() = std::numeric_limits<double>::quiet_NaN();
  ImuSample infinite = sample_at(5);
  infinite.angular_rate_radps.z() = -std::numeric_limits<double>::infinity();
  ImuSample too_fast = sample_at(5);
  too_fast.angular_rate_radps.y() = -41.0;
  ImuSample too_hard = sample_at(5);
  too_hard.specific_force_mps2.x() = 321.0;

  EXPECT_FALSE(sut.push(not_finite));
  EXPECT_FALSE(sut.push(infinite));
  EXPECT_FALSE(sut.push(too_fast));
  EXPECT_FALSE(sut.push(too_hard));

  EXPECT_EQ(sut.counts().refused_for(ImuRefusal::kNotFinite), 2U);
  EXPECT_EQ(sut.counts().refused_for(ImuRefusal::kImplausible), 2U);
  EXPECT_EQ(sut.size(), 1U);
}

TEST(ImuBuffer, LetsTheOldestGoWhenFull) {
  const ImuBuffer sut = filled(4, 11);

  EXPECT_EQ(sut.size(), 4U);
  EXPECT_EQ(sut.oldest().stamp, at_ms(35));
  EXPECT_EQ(sut.newest().stamp, at_ms(50));
  EXPECT_EQ(sut.counts().overwritten, 7U);
  EXPECT_EQ(sut.samples().size(), 4U);
}

TEST(ImuBuffer, GivesSamplesAfterT0UpToT1InAContiguousRun) {
  for (int samples = 1; samples < 30; ++samples) {  // every position of the ring
    const ImuBuffer sut = filled(7, samples);
    const std::int64_t newest = 5 * (samples - 1);

    const auto sut_run = sut.between(at_ms(newest - 15), at_ms(newest - 5));

    const std::size_t expected = samples >= 4 ? 2 : (samples >= 2 ? samples - 1U : 0U);
    ASSERT_EQ(sut_run.size(), expected) << samples;
    for (std::size_t i = 0; i < expected; ++i) {
      const auto steps_back = static_cast<std::int64_t>(expected - i);
      EXPECT_EQ(sut_run[i].stamp, at_ms(newest - 5 * steps_back));
    }
  }
}

TEST(ImuBuffer, GivesNothingBetweenStampsOutsideOrReversed) {
  const ImuBuffer sut = filled(8, 4);

  EXPECT_TRUE(sut.between(at_ms(15), at_ms(100)).empty());
  EXPECT_TRUE(sut.between(at_ms(-20), at_ms(-1)).empty());
  EXPECT_TRUE(sut.between(at_ms(10), at_ms(5)).empty());
  EXPECT_TRUE(ImuBuffer(ImuBufferConfig{}).between(at_ms(0), at_ms(5)).empty());
}

TEST(ImuBuffer, CoversFromTheOldestToTheNewestStamp) {
  const ImuBuffer sut = filled(8, 4);

  EXPECT_TRUE(sut.covers(at_ms(0)));
  EXPECT_TRUE(sut.covers(at_ms(7)));
  EXPECT_TRUE(sut.covers(at_ms(15)));
  EXPECT_FALSE(sut.covers(at_ms(-1)));
  EXPECT_FALSE(sut.covers(at_ms(16)));
  EXPECT_FALSE(ImuBuffer(ImuBufferConfig{}).covers(at_ms(0)));
}

TEST(ImuBuffer, InterpolatesBetweenSamplesAndHitsThemExactly) {
  const ImuBuffer sut = filled(8, 4);

  const auto between = sut.at(at_ms(7));
  const auto exact = sut.at(at_ms(10));

  ASSERT_TRUE(between && exact);
  EXPECT_EQ(between->stamp, at_ms(7));
  EXPECT_NEAR(between->angular_rate_radps.x(), 0.07, 1e-12);
  EXPECT_NEAR(between->specific_force_mps2.z(), 9.81, 1e-12);
  EXPECT_DOUBLE_EQ(exact->angular_rate_radps.x(), 0.10);
  EXPECT_FALSE(sut.at(at_ms(16)));
  EXPECT_FALSE(sut.at(at_ms(-1)));
}

TEST(ImuBuffer, StillInterpolatesAtTheStampBeforeWhichItDropped) {
  ImuBuffer sut = filled(8, 8);

  sut.drop_before(at_ms(17));

  EXPECT_EQ(sut.oldest().stamp, at_ms(15));
  EXPECT_TRUE(sut.at(at_ms(17)));
  EXPECT_EQ(sut.size(), 5U);
  EXPECT_TRUE(sut.push(sample_at(40)));
  EXPECT_EQ(sut.samples().back().stamp, at_ms(40));
}

TEST(ImuBuffer, DropsNothingBeforeItsFirstStampAndKeepsTheLast) {
  ImuBuffer sut = filled(8, 3);

  sut.drop_before(at_ms(-5));
  EXPECT_EQ(sut.size(), 3U);

  sut.drop_before(at_ms(1000));
  EXPECT_EQ(sut.size(), 1U);
  EXPECT_EQ(sut.oldest().stamp, at_ms(10));
}

TEST(ImuBuffer, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  ImuBuffer sut = filled(64, 1);
  std::size_t seen = 0;

  const std::size_t allocations = support::count_allocations([&] {
    for (int i = 1; i < 1000; ++i) {
      sut.push(sample_at(5 * i));
      sut.push(sample_at(5 * i));
      seen += sut.between(at_ms(5 * i - 20), at_ms(5 * i)).size();
      seen += sut.at(at_ms(5 * i - 2)) ? 1 : 0;
      sut.drop_before(at_ms(5 * i - 50));
    }
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_GT(seen, 4000U);
}

TEST(ImuBuffer, NamesEveryReason) {
  EXPECT_EQ(to_string(ImuRefusal::kDuplicate), "duplicate");
  EXPECT_EQ(to_string(ImuRefusal::kOutOfOrder), "out_of_order");
  EXPECT_EQ(to_string(ImuRefusal::kNotFinite), "not_finite");
  EXPECT_EQ(to_string(ImuRefusal::kImplausible), "implausible");
  EXPECT_EQ(to_string(ImuRefusal::kFarAhead), "far_ahead");
}

}  // namespace
}  // namespace slamd::sensor
