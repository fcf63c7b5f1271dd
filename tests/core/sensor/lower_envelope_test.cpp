#include "core/sensor/lower_envelope.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace slamd::sensor {
namespace {

using Sample = LowerEnvelope::Sample;

constexpr double kBucket_ns = 100e6;

// Of all lines through two samples below all others, the slope of the one with the least sum of
// distances.
double slope_by_trying_all(const std::vector<Sample>& samples) {
  double best_slope = 0.0;
  double least_sum = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t j = i + 1; j < samples.size(); ++j) {
      const double slope =
          (samples[j].y_ns - samples[i].y_ns) / (samples[j].x_ns - samples[i].x_ns);
      double sum = 0.0;
      for (const Sample& sample : samples) {
        const double above =
            sample.y_ns - samples[i].y_ns - slope * (sample.x_ns - samples[i].x_ns);
        sum += above < -1e-3 ? std::numeric_limits<double>::infinity() : above;
      }
      if (sum < least_sum) {
        least_sum = sum;
        best_slope = slope;
      }
    }
  }
  return best_slope;
}

TEST(LowerEnvelope, IsTheClosestLineBelowAllSamples) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::exponential_distribution<double> jitter(1.0 / 1e6);
    LowerEnvelope sut(1.0);
    std::vector<Sample> samples;
    for (int i = 0; i < 20 + static_cast<int>(seed) * 2; ++i) {
      samples.push_back({(i + 0.5) * kBucket_ns, 40e-6 * i * kBucket_ns + jitter(random)});
    }

    sut.restart(samples[0]);
    for (const Sample& sample : samples) {
      sut.add(sample);
    }
    // Opens the next bucket, high above, and so fits the line to the samples.
    sut.add({samples.back().x_ns + kBucket_ns, 1e12});

    EXPECT_NEAR(sut.slope(), slope_by_trying_all(samples), 1e-12);
    for (const Sample& sample : samples) {
      EXPECT_GE(sample.y_ns - sut.at(sample.x_ns), -1e-3);
    }
  }
}

TEST(LowerEnvelope, SinksAtOnceToASampleBelow) {
  LowerEnvelope sut(1.0);
  sut.restart({0.0, 500.0});

  sut.add({10.0, 300.0});
  sut.add({20.0, 400.0});

  EXPECT_DOUBLE_EQ(sut.at(20.0), 300.0);
}

TEST(LowerEnvelope, KeepsItsSlopeWithinTheLimit) {
  LowerEnvelope sut(1e-4);
  sut.restart({0.0, 0.0});

  for (int i = 0; i < 100; ++i) {
    sut.add({i * kBucket_ns, i * kBucket_ns * 1e-2});
  }

  EXPECT_DOUBLE_EQ(sut.slope(), 1e-4);
  EXPECT_LE(sut.at(0.0), 1e-3);
}

TEST(LowerEnvelope, ForgetsWhatIsOlderThanItsWindow) {
  LowerEnvelope sut(1e-4);
  sut.restart({0.0, -5e6});

  for (int i = 1; i < 128; ++i) {
    sut.add({i * kBucket_ns, 0.0});
  }
  EXPECT_LT(sut.at(0.0), -4e6);
  for (int i = 128; i < 140; ++i) {
    sut.add({i * kBucket_ns, 0.0});
  }

  EXPECT_DOUBLE_EQ(sut.at(140 * kBucket_ns), 0.0);
}

TEST(LowerEnvelope, RestartKeepsTheSlopeOnly) {
  LowerEnvelope sut(1e-3);
  sut.restart({0.0, 0.0});
  for (int i = 0; i < 30; ++i) {
    sut.add({i * kBucket_ns, i * kBucket_ns * 1e-4});
  }

  sut.restart({0.0, 7e9});

  EXPECT_NEAR(sut.slope(), 1e-4, 1e-12);
  EXPECT_DOUBLE_EQ(sut.at(0.0), 7e9);
}

}  // namespace
}  // namespace slamd::sensor
