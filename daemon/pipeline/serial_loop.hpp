#pragma once

#include "daemon/configuration/configuration.hpp"
#include "daemon/pipeline/serial_line.hpp"
#include "daemon/threads/event_ring.hpp"
#include "drivers/imu/line_setup.hpp"
#include "drivers/transport/host_clock.hpp"

namespace slamd::pipeline {

/// The serial thread, an ordinary one: opens the inertial sensor's port, finds its rate and configures the sensor as far
/// as the configuration wants that, and hands the port to the receive thread; opens it anew when it comes back.
/// Threads: one.  Allocates in the constructor only; blocks where the driver does.
class SerialLoop {
 public:
  static constexpr Duration kRetry = std::chrono::milliseconds(500);

  SerialLoop(const configuration::Configuration& configuration, const transport::HostClock& clock, SerialLine& line);

  /// Does what is to be done, or sleeps, at most for `longest`.
  void run_once(Duration longest);

  threads::EventRing& events() { return events_; }

 private:
  void close();
  void open();
  void set_up(Duration longest);
  void carry_out(imu::LineOutput& out);

  transport::HostClock clock_;
  SerialLine& line_;
  imu::LineSetup setup_;
  bool handed_on_ = false;
  int refused_ = 0;  // errno of the last open(), so that it is told once
  Stamp next_try_{};
  threads::EventRing events_;
};

}  // namespace slamd::pipeline
