#pragma once

#include <array>
#include <cstddef>

#include "core/base/stamp.hpp"

namespace slamd::transport {

/// Finds the rate of a serial line as gpsd does: listens at one after the other, the last good one first, until good
/// frames come. A rate at which nothing comes is probed once, for the sensor may only speak when it is spoken to.
/// Real-time: never allocates; one thread.
class BaudHunt {
 public:
  static constexpr std::array<int, 10> kRates{115'200, 921'600, 460'800, 230'400, 2'000'000,
                                              1'000'000, 57'600, 38'400, 19'200, 9'600};
  static constexpr Duration kProbeAfter = std::chrono::milliseconds{250};
  static constexpr Duration kDwell = std::chrono::milliseconds{600};
  static constexpr int kFrames = 2;  // so many good ones are no accident

  /// dwell: how long it listens at each rate; longer than a sensor's pauses.
  explicit BaudHunt(Duration dwell = kDwell) : dwell_(dwell) {}

  /// Begins to listen at the rate that was good last.
  void begin(Stamp now);

  /// Notes a good frame at the present rate.
  void hear(Stamp now);

  /// Notes the answer to a probe, which nothing else looks like.
  void hear_answer() { found_ = true; }

  /// Lets time pass. Returns whether the port must be set to another rate.
  bool advance(Stamp now);

  /// Tells, once for each rate, that a probe is due.
  bool take_probe(Stamp now);

  int baud() const { return kRates[rate_]; }
  bool found() const { return found_; }

  /// Rounds through all rates without anything.
  int rounds() const { return tried_ / static_cast<int>(kRates.size()); }

 private:
  Duration dwell_;
  std::size_t rate_ = 0;
  int tried_ = 0;
  int frames_ = 0;
  bool probed_ = false;
  bool found_ = false;
  Stamp until_{};
  Stamp probe_at_{};
};

}  // namespace slamd::transport
