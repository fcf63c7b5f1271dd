#pragma once

#include <memory>
#include <string>

#include "drivers/transport/can_socket.hpp"
#include "drivers/transport/host_clock.hpp"
#include "tools/sensors/can_watch.hpp"

namespace slamd::sensors {

/// Listens to a CAN interface, beside whoever else does; sends nothing.
/// Threads: one.
class BusPlace {
 public:
  BusPlace(const std::string& interface, const transport::HostClock& clock);

  /// Looks for the interface, which may come and go.
  void attend();

  void run_once();
  void end_second() { watch_.end_second(); }

  const std::string& interface() const { return interface_; }

  /// For poll; -1 where this kernel has no CAN.
  int fd() const { return socket_ ? socket_->fd() : -1; }

  BusSeen seen() const;

 private:
  std::string interface_;
  std::string trouble_;
  std::unique_ptr<transport::CanSocket> socket_;
  CanWatch watch_;
};

}  // namespace slamd::sensors
