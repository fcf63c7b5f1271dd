#pragma once

#include <string>

#include "core/base/stamp.hpp"
#include "drivers/transport/serial_port.hpp"
#include "tools/sensors/serial_watch.hpp"

namespace slamd::sensors {

/// Listens to a serial line as long as nobody else does: a second reader would take bytes from the first. A line that is
/// absent, refused or held is tried again; one that was unplugged is listened to again when it is back.
/// Threads: one.
class SerialPlace {
 public:
  static constexpr Duration kRetry = std::chrono::seconds(1);

  /// asks: whether the device may be asked anything.
  SerialPlace(const std::string& device, bool asks, Stamp now);

  /// Reads what waits, and does what is due.
  void run_once(Stamp now);

  void end_second() { watch_.end_second(); }

  const std::string& device() const { return device_; }

  /// For poll; -1 while it is not open.
  int fd() const { return port_.fd(); }

  LineSeen seen() const;

 private:
  bool is_held();
  void open(Stamp now);
  bool yield(Stamp now);

  std::string device_;
  bool asks_;
  transport::SerialPort port_;
  SerialWatch watch_;
  std::string trouble_;
  Stamp next_try_{};
  Stamp next_look_{};  // whether somebody else has opened it
};

}  // namespace slamd::sensors
