#include "core/base/histogram.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace slamd {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;

// The exact percentile: the value with rank ceil(p/100 * n) of the sorted ones.
Duration nearest_rank(std::vector<Duration> values, double percent) {
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(percent / 100.0 * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

TEST(Histogram, IsZeroWhenEmpty) {
  const Histogram sut;

  EXPECT_EQ(sut.count(), 0U);
  EXPECT_EQ(sut.min(), Duration::zero());
  EXPECT_EQ(sut.max(), Duration::zero());
  EXPECT_EQ(sut.mean(), Duration::zero());
  EXPECT_EQ(sut.percentile(99.0), Duration::zero());
}

TEST(Histogram, IsExactForOneValue) {
  Histogram sut;

  sut.add(Duration{1'234'567});

  for (const double percent : {0.0, 50.0, 100.0}) {
    EXPECT_EQ(sut.percentile(percent), Duration{1'234'567});
  }
  EXPECT_EQ(sut.min(), Duration{1'234'567});
  EXPECT_EQ(sut.mean(), Duration{1'234'567});
}

TEST(Histogram, PercentilesAreWithinTheStatedErrorAndNeverBelow) {
  std::mt19937_64 random(3);
  for (const double scale_ns : {20.0, 900.0, 5e4, 3e6, 1e9, 1e10}) {
    Histogram sut;
    std::vector<Duration> values;
    std::lognormal_distribution<double> distribution(std::log(scale_ns), 1.0);
    for (int i = 0; i < 5000; ++i) {
      const Duration value{static_cast<std::int64_t>(distribution(random))};
      values.push_back(value);
      sut.add(value);
    }

    for (const double percent : {0.0, 1.0, 25.0, 50.0, 90.0, 99.0, 99.9, 100.0}) {
      const Duration exact = nearest_rank(values, percent);
      const Duration found = sut.percentile(percent);
      EXPECT_GE(found, exact) << percent << " of " << scale_ns;
      EXPECT_LE(to_seconds(found), to_seconds(exact) * (1.0 + Histogram::kRelativeError))
          << percent;
    }
    EXPECT_EQ(sut.min(), *std::min_element(values.begin(), values.end()));
    EXPECT_EQ(sut.max(), *std::max_element(values.begin(), values.end()));
    EXPECT_EQ(sut.percentile(100.0), sut.max());
  }
}

TEST(Histogram, BoundsItsErrorAtEveryPowerOfTwo) {
  for (int bits = 0; bits < 40; ++bits) {
    for (const std::int64_t offset : {-1, 0, 1}) {
      const Duration value{(std::int64_t{1} << bits) + offset};
      Histogram sut;
      sut.add(value);
      sut.add(value);
      sut.add(hours{5});  // so that the result is not clipped to max

      const Duration found = sut.percentile(50.0);

      EXPECT_GE(found, value);
      EXPECT_LE(to_seconds(found - value), to_seconds(value) * Histogram::kRelativeError);
    }
  }
}

TEST(Histogram, KeepsExtremesOfWhatLiesOutsideItsBuckets) {
  Histogram sut;

  sut.add(Duration{-5});
  sut.add(hours{2});
  sut.add(hours{3});

  EXPECT_EQ(sut.min(), Duration{-5});
  EXPECT_EQ(sut.max(), hours{3});
  EXPECT_EQ(sut.percentile(60.0), hours{3});
  EXPECT_EQ(sut.percentile(1.0), Duration{0});
}

TEST(Histogram, MergeEqualsAddingAllToOne) {
  std::mt19937_64 random(4);
  Histogram a;
  Histogram b;
  Histogram all;
  for (int i = 0; i < 1000; ++i) {
    const Duration value{static_cast<std::int64_t>(random() % 10'000'000)};
    (i % 3 == 0 ? a : b).add(value);
    all.add(value);
  }

  a.merge(b);
  a.merge(Histogram{});

  EXPECT_EQ(a.count(), all.count());
  EXPECT_EQ(a.min(), all.min());
  EXPECT_EQ(a.max(), all.max());
  EXPECT_EQ(a.mean(), all.mean());
  for (int percent = 0; percent <= 100; ++percent) {
    EXPECT_EQ(a.percentile(percent), all.percentile(percent));
  }
}

TEST(Histogram, ClearForgetsEverything) {
  Histogram sut;
  sut.add(milliseconds{5});

  sut.clear();
  sut.add(milliseconds{1});

  EXPECT_EQ(sut.count(), 1U);
  EXPECT_EQ(sut.max(), milliseconds{1});
  EXPECT_EQ(sut.percentile(100.0), milliseconds{1});
}

TEST(Histogram, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Duration found{};

  const std::size_t allocations = support::count_allocations([&found] {
    Histogram sut;
    Histogram other;
    for (int i = 0; i < 1000; ++i) {
      sut.add(Duration{i * i});
      other.add(Duration{i});
    }
    sut.merge(other);
    found = sut.percentile(99.0);
    sut.clear();
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_GT(found, Duration{900'000});
}

}  // namespace
}  // namespace slamd
