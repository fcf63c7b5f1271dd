#pragma once

#include "core/base/stamp.hpp"

namespace slamd::transport {

/// The host's two clocks at one moment, each since its own origin.
struct ClockReadings {
  Duration monotonic{};
  Duration realtime{};

  Duration realtime_minus_monotonic() const { return realtime - monotonic; }
};

/// Reads CLOCK_MONOTONIC and CLOCK_REALTIME so close together that their difference is good to a microsecond or so.
ClockReadings read_clocks();

/// slamd's time base on this host: CLOCK_MONOTONIC plus one offset, which is taken from the wall clock at construction
/// and never changes (design.md, "Frames, time, signs"). A program makes one and hands out copies.
///
/// The wall clock may step while slamd runs. Stamps that are made of it (the kernel's receive stamps) are converted by
/// the difference of the two clocks at the time of conversion, so that slamd's own time does not step along.
/// Threads: immutable; any thread may call any method. Real-time: no allocation, no system call beyond the vDSO.
class HostClock {
 public:
  using Reader = ClockReadings (*)();

  explicit HostClock(Reader reader = &read_clocks);

  /// Returns the present on the time base.
  Stamp now() const { return from_monotonic(reader_().monotonic); }

  /// Reads the two clocks, for the conversions of one batch.
  ClockReadings read() const { return reader_(); }

  Stamp from_monotonic(Duration monotonic) const { return Stamp{} + offset_ + monotonic; }

  /// Returns what CLOCK_MONOTONIC shows at a stamp: for timers and absolute sleeps.
  Duration monotonic_of(Stamp stamp) const { return stamp.time_since_epoch() - offset_; }

  /// Converts a wall clock time; `current` are readings from about the moment at which it was taken.
  Stamp from_realtime(Duration realtime, const ClockReadings& current) const {
    return from_monotonic(realtime - current.realtime_minus_monotonic());
  }

  /// What is added to CLOCK_MONOTONIC.
  Duration offset() const { return offset_; }

 private:
  Reader reader_;
  Duration offset_;
};

}  // namespace slamd::transport
