#pragma once

#include <algorithm>
#include <chrono>

#include "core/base/stamp.hpp"

namespace slamd::bus {

/// Lets so many messages pass at once, and so many a second on average: a token bucket.
/// Threads: one.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  RateLimit(int burst, int per_second) : burst_(burst), per_second_(per_second), tokens_(burst) {}

  /// Tells whether a message may pass now, and counts it if so.
  bool admits(Clock::time_point now) {
    const double passed_s = filled_ == Clock::time_point{} ? 0.0 : to_seconds(now - filled_);
    tokens_ = std::min(burst_, tokens_ + per_second_ * passed_s);
    filled_ = now;
    if (tokens_ < 1.0) {
      return false;
    }
    tokens_ -= 1.0;
    return true;
  }

 private:
  double burst_;
  double per_second_;
  double tokens_;
  Clock::time_point filled_{};  // when tokens_ was right
};

}  // namespace slamd::bus
