#include "core/sensor/lower_envelope.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::sensor {

namespace {

constexpr double kBucket_ns = 100e6;
constexpr double kWindow_ns = 12.8e9;
constexpr double kFitSpan_ns = 1e9;  // a shorter window says nothing about the slope

}  // namespace

void LowerEnvelope::restart(const Sample& sample) {
  point_ = sample;
  first_ = 0;
  count_ = 1;
  buckets_[0] = sample;
  newest_begin_ns_ = std::floor(sample.x_ns / kBucket_ns) * kBucket_ns;
}

void LowerEnvelope::add(const Sample& sample) {
  if (sample.y_ns < at(sample.x_ns)) {
    point_ = sample;
  }
  if (count_ > 0 && sample.x_ns < newest_begin_ns_ + kBucket_ns) {
    Sample& newest = buckets_[(first_ + count_ - 1) % kBuckets];
    if (sample.y_ns < newest.y_ns) {
      newest = sample;
    }
    return;
  }
  fit();
  while (count_ > 0 && (count_ == kBuckets || sample.x_ns - bucket(0).x_ns > kWindow_ns)) {
    first_ = (first_ + 1) % kBuckets;
    --count_;
  }
  buckets_[(first_ + count_) % kBuckets] = sample;
  ++count_;
  newest_begin_ns_ = std::floor(sample.x_ns / kBucket_ns) * kBucket_ns;
}

// Lays the line anew below all buckets. Until they span a second, the old line holds and only
// sinks.
void LowerEnvelope::fit() {
  if (count_ < 2 || bucket(count_ - 1).x_ns - bucket(0).x_ns < kFitSpan_ns) {
    return;
  }
  slope_ = std::clamp(closest_slope(), -max_slope_, max_slope_);
  point_ = bucket(0);
  for (std::size_t i = 1; i < count_; ++i) {
    if (bucket(i).y_ns < at(bucket(i).x_ns)) {
      point_ = bucket(i);
    }
  }
}

// The slope of the samples' lower convex hull at their mean x: that line below them has the least
// sum of distances.
double LowerEnvelope::closest_slope() const {
  const auto slope = [this](std::size_t a, std::size_t b) {
    return (bucket(b).y_ns - bucket(a).y_ns) / (bucket(b).x_ns - bucket(a).x_ns);
  };
  std::array<std::size_t, kBuckets> hull{};
  std::size_t size = 0;
  double mean_x_ns = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    mean_x_ns += (bucket(i).x_ns - bucket(0).x_ns) / static_cast<double>(count_);
    while (size >= 2 && slope(hull[size - 2], hull[size - 1]) >= slope(hull[size - 1], i)) {
      --size;
    }
    hull[size++] = i;
  }
  std::size_t edge = 1;
  while (edge + 1 < size && bucket(hull[edge]).x_ns - bucket(0).x_ns < mean_x_ns) {
    ++edge;
  }
  return slope(hull[edge - 1], hull[edge]);
}

}  // namespace slamd::sensor
