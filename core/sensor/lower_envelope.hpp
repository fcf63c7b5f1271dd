#pragma once

#include <array>
#include <cstddef>

namespace slamd::sensor {

/// The line below all (device time, arrival - device time) samples of a sliding window that lies
/// closest to them. Of each 100 ms of device time it keeps the lowest sample; the window is 12.8 s.
/// A sample below the line lowers it at once; its slope follows every 100 ms, once the window spans
/// a second.
/// Units: ns, counted from wherever the caller likes, best within days, where a double resolves
/// picoseconds.
/// Source: Moon, Skelly, Towsley, "Estimation and removal of clock skew from network delay
/// measurements" (INFOCOM 1999): of all lines below the samples, the one with the least sum of
/// distances.
/// Real-time: fixed memory, no allocation; add() is O(1), and O(128) once in 100 ms.
class LowerEnvelope {
 public:
  struct Sample {
    double x_ns = 0.0;
    double y_ns = 0.0;
  };

  /// The slope stays within ±max_slope.
  explicit LowerEnvelope(double max_slope) : max_slope_(max_slope) {}

  /// Forgets all samples but this one; keeps the slope.
  void restart(const Sample& sample);

  /// Takes a sample in.
  /// Errors: x must not be less than that of the last one.
  void add(const Sample& sample);

  double at(double x_ns) const { return point_.y_ns + slope_ * (x_ns - point_.x_ns); }

  double slope() const { return slope_; }

 private:
  static constexpr std::size_t kBuckets = 128;

  void fit();
  double closest_slope() const;

  const Sample& bucket(std::size_t i) const { return buckets_[(first_ + i) % kBuckets]; }

  double max_slope_;
  // The line passes through point_.
  Sample point_{};
  double slope_ = 0.0;
  // The lowest sample of each 100 ms that has any, oldest first from first_ on.
  std::array<Sample, kBuckets> buckets_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  double newest_begin_ns_ = 0.0;
};

}  // namespace slamd::sensor
