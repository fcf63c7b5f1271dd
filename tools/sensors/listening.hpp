#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/stamp.hpp"
#include "drivers/transport/host_clock.hpp"
#include "tools/sensors/bus_place.hpp"
#include "tools/sensors/network_watch.hpp"
#include "tools/sensors/seen.hpp"
#include "tools/sensors/serial_place.hpp"
#include "tools/sensors/udp_place.hpp"

namespace slamd::sensors {

struct ListeningConfig {
  std::vector<std::uint16_t> ports;        // of this host, beside the sensors' own
  std::vector<std::string> serial;         // lines, beside the adapters that are plugged in
  std::vector<std::string> can;            // interfaces, beside those that the kernel has
  bool finds_serial = true;                // listens to adapters as they are plugged in
  bool asks = false;                       // devices that were found, and those on serial lines, for more than they say
};

/// Listens at all places where sensors speak: the network, serial lines, CAN buses. It holds no device and changes none:
/// on the network it asks who is there, as every host of SDK2 devices does once a second, and nothing else until it may.
/// Threads: one.
class Listening {
 public:
  Listening(const ListeningConfig& config, const transport::HostClock& clock);

  /// Takes what comes, and does what is due; returns after `longest` at the latest.
  void run_once(Duration longest);

  /// A second is over: counts begin anew, and what came or went is looked for.
  void end_second();

  Seen seen() const;

 private:
  void find_places();
  void search();

  ListeningConfig config_;
  transport::HostClock clock_;
  Stamp began_;
  std::vector<transport::Interface> interfaces_;
  NetworkWatch network_;
  std::vector<std::unique_ptr<UdpPlace>> ports_;
  UdpPlace* searching_ = nullptr;  // of ports_: from which SDK2 devices are asked
  std::vector<std::unique_ptr<SerialPlace>> lines_;
  std::vector<std::unique_ptr<BusPlace>> buses_;
  std::uint32_t questions_ = 0;
};

}  // namespace slamd::sensors
