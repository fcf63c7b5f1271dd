#pragma once

#include <cstdint>
#include <optional>

#include "core/base/histogram.hpp"
#include "core/base/latest.hpp"
#include "core/base/stamp.hpp"

namespace slamd::threads {

/// What one kind of work took over the last period.
struct StageTime {
  Duration p50{};
  Duration p99{};
  Duration max{};
  std::uint64_t count = 0;
};

/// Measures one kind of work in one thread and shows the last period's summary, and that since the start, to all others.
/// Threads: add() by one; the others by any.  Real-time: never allocates.
class StageMonitor {
 public:
  static constexpr Duration kPeriod = std::chrono::seconds(2);

  void add(Duration took, Stamp now) {
    if (now - begin_ >= kPeriod) {
      if (period_.count() > 0) {
        shown_.store(summary(period_));
      }
      shown_total_.store(summary(total_));
      period_.clear();
      begin_ = now;
    }
    period_.add(took);
    total_.add(took);
  }

  StageTime last_period() const { return shown_.load().value_or(StageTime{}); }
  StageTime total() const { return shown_total_.load().value_or(StageTime{}); }

 private:
  static StageTime summary(const Histogram& histogram) {
    return {histogram.percentile(50.0), histogram.percentile(99.0), histogram.max(), histogram.count()};
  }

  // The measuring thread's own.
  Histogram period_;
  Histogram total_;
  Stamp begin_{};
  // Written by the measuring thread, read by health.
  Latest<StageTime> shown_;
  Latest<StageTime> shown_total_;
};

}  // namespace slamd::threads
