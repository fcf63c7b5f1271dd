#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/stamp.hpp"
#include "drivers/transport/host_clock.hpp"
#include "drivers/transport/wire_listener.hpp"
#include "tools/sensors/avia_question.hpp"
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
  std::vector<std::uint32_t> avias;        // to be asked whether they have a host; addresses in host order
  bool asks = false;                       // devices that were found, and those on serial lines, for more than they say
};

/// Adds the ports, lines and buses of a configuration to those that are listened to.
void add_places_of(const configuration::Configuration& configuration, ListeningConfig& listening);

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
  void ask_avias();
  void hear_avias();
  void send_to_avia(const livox::FrameBytes& bytes, std::uint32_t address);
  void hear_wire();

  ListeningConfig config_;
  transport::HostClock clock_;
  Stamp began_;
  std::vector<transport::Interface> interfaces_;
  NetworkWatch network_;
  std::vector<std::unique_ptr<UdpPlace>> ports_;
  std::unique_ptr<transport::WireListener> wire_;  // nullptr: it must not be listened to
  NetworkWatch beyond_;                            // of the wire: what is of no subnet of this host
  std::vector<AviaQuestion> avias_;
  std::unique_ptr<transport::DatagramSocket> avia_socket_;
  std::string hindrance_;  // why no Avia is asked
  UdpPlace* searching_ = nullptr;  // of ports_: from which SDK2 devices are asked
  std::vector<std::unique_ptr<SerialPlace>> lines_;
  std::vector<std::unique_ptr<BusPlace>> buses_;
  std::uint32_t questions_ = 0;
};

}  // namespace slamd::sensors
