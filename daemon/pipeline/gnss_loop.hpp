#pragma once

#include "core/base/latest.hpp"
#include "daemon/configuration/configuration.hpp"
#include "daemon/stages/gnss_stage.hpp"
#include "daemon/stages/packet_stage.hpp"
#include "daemon/threads/event_ring.hpp"
#include "drivers/transport/baud_hunt.hpp"
#include "drivers/transport/host_clock.hpp"
#include "drivers/transport/serial_port.hpp"

namespace slamd::pipeline {

/// The receiver's thread, an ordinary one: opens its serial port, finds its rate where none is configured, reads its
/// fixes, and opens the port anew when it was unplugged. A few fixes a second do not need the receive thread.
/// Threads: run_once() by one; state() by any.  Allocates in the constructor only; blocks where the driver does.
class GnssLoop {
 public:
  static constexpr Duration kRetry = std::chrono::milliseconds(500);
  /// Longer than a receiver's second, or its burst of sentences would always be missed.
  static constexpr Duration kDwell = std::chrono::milliseconds(1300);
  /// At a rate that was found, nothing readable for so long: it is looked for anew.
  static constexpr Duration kMute = std::chrono::seconds(5);

  GnssLoop(const configuration::Configuration& configuration, const transport::HostClock& clock);

  /// Does what is to be done, or sleeps, at most for `longest`.
  void run_once(Duration longest);

  stages::GnssState state() const { return shown_.load().value_or(stages::GnssState{}); }
  threads::EventRing& events() { return events_; }

  /// For after the thread has ended.
  stages::NamedCounts counts() const { return stage_.counts(); }

 private:
  void open(Duration longest);
  void read(Duration longest);
  void listen(Stamp now, std::uint64_t messages);
  void close();

  transport::HostClock clock_;
  transport::SerialPort port_;
  bool hunts_;
  transport::BaudHunt hunt_{kDwell};
  stages::GnssStage stage_;
  bool had_fix_ = false;
  bool was_found_ = false;
  int refused_ = 0;  // errno of the last open(), so that it is told once
  Stamp heard_{};    // a message, or the beginning
  Stamp next_try_{};
  // Written by this thread, read by housekeeping.
  Latest<stages::GnssState> shown_;
  threads::EventRing events_;
};

}  // namespace slamd::pipeline
