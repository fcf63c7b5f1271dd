#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/assert.hpp"
#include "core/base/stamp.hpp"

namespace slamd {

/// Counts latencies in log-linear buckets: 1 ns wide below 64 ns, then 32 to each doubling, up to
/// 18 minutes. A percentile is never below the exact one (nearest rank) and above it by at most
/// 1/32 = 3.1 %; min, max, mean and count are exact. Longer latencies share the last bucket, whose
/// percentile is max; negative ones the first.
/// Real-time: fixed size (9 KiB), never allocates; add() is O(1); one thread.
class Histogram {
 public:
  static constexpr double kRelativeError = 1.0 / 32.0;

  void add(Duration latency) {
    ++buckets_[bucket_of(latency)];
    min_ = count_ == 0 ? latency : std::min(min_, latency);
    max_ = count_ == 0 ? latency : std::max(max_, latency);
    sum_ += latency;
    ++count_;
  }

  /// Adds all that another one has counted.
  void merge(const Histogram& other) {
    if (other.count_ == 0) {
      return;
    }
    for (std::size_t i = 0; i < kBuckets; ++i) {
      buckets_[i] += other.buckets_[i];
    }
    min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
    max_ = count_ == 0 ? other.max_ : std::max(max_, other.max_);
    sum_ += other.sum_;
    count_ += other.count_;
  }

  void clear() { *this = Histogram{}; }

  std::uint64_t count() const { return count_; }

  /// The exact extremes and mean; zero when empty.
  Duration min() const { return min_; }

  Duration max() const { return max_; }

  Duration mean() const {
    return count_ == 0 ? Duration::zero() : sum_ / static_cast<std::int64_t>(count_);
  }

  /// The latency that percent (0..100) of the counted ones do not exceed; zero when empty.
  Duration percentile(double percent) const {
    SLAMD_ASSERT(percent >= 0.0 && percent <= 100.0);
    if (count_ == 0) {
      return Duration::zero();
    }
    const double share = percent / 100.0 * static_cast<double>(count_);
    const auto rank =
        std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::ceil(share)), 1, count_);
    std::uint64_t seen = 0;
    std::size_t bucket = 0;
    while (bucket + 1 < kBuckets && seen + buckets_[bucket] < rank) {
      seen += buckets_[bucket++];
    }
    return bucket + 1 == kBuckets ? max_ : std::clamp(highest_of(bucket), min_, max_);
  }

 private:
  static constexpr std::size_t kSteps = 32;  // to each doubling
  static constexpr int kStepBits = 5;
  static constexpr int kLargestBits = 40;  // 2^40 ns = 18 min
  static constexpr std::size_t kBuckets = 2 * kSteps + (kLargestBits - kStepBits - 1) * kSteps;

  static std::size_t bucket_of(Duration latency) {
    const auto value = static_cast<std::uint64_t>(std::max(latency, Duration::zero()).count());
    if (value < 2 * kSteps) {
      return value;
    }
    const int shift = std::bit_width(value) - 1 - kStepBits;
    return std::min(kBuckets - 1, static_cast<std::size_t>(shift) * kSteps + (value >> shift));
  }

  static Duration highest_of(std::size_t bucket) {
    if (bucket < 2 * kSteps) {
      return Duration{bucket};
    }
    const std::size_t shift = bucket / kSteps - 1;
    const std::uint64_t step = bucket % kSteps + kSteps;
    return Duration{((step + 1) << shift) - 1};
  }

  std::uint64_t count_ = 0;
  Duration min_{};
  Duration max_{};
  Duration sum_{};
  std::array<std::uint64_t, kBuckets> buckets_{};
};

}  // namespace slamd
