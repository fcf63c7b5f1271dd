#include "drivers/transport/host_clock.hpp"

#include <ctime>

namespace slamd::transport {

namespace {

Duration read_clock(clockid_t clock) {
  std::timespec now{};
  clock_gettime(clock, &now);
  return std::chrono::seconds(now.tv_sec) + Duration(now.tv_nsec);
}

}  // namespace

ClockReadings read_clocks() {
  constexpr int kAttempts = 5;
  constexpr Duration kCloseEnough = std::chrono::microseconds(1);
  ClockReadings best;
  Duration best_gap = Duration::max();
  for (int i = 0; i < kAttempts && best_gap > kCloseEnough; ++i) {  // the thread may be put aside between two readings
    const Duration before = read_clock(CLOCK_MONOTONIC);
    const Duration realtime = read_clock(CLOCK_REALTIME);
    const Duration gap = read_clock(CLOCK_MONOTONIC) - before;
    if (gap < best_gap) {
      best_gap = gap;
      best = {before + gap / 2, realtime};
    }
  }
  return best;
}

HostClock::HostClock(Reader reader) : reader_(reader), offset_(reader().realtime_minus_monotonic()) {}

}  // namespace slamd::transport
