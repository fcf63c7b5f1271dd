#include "tools/sensors/listening.hpp"

#include <algorithm>

#include <poll.h>

#include "drivers/livox/sdk1_host.hpp"
#include "drivers/livox/sdk2_frame.hpp"
#include "drivers/livox/sdk2_host.hpp"
#include "drivers/livox/sdk2_setup.hpp"
#include "drivers/transport/port_owner.hpp"
#include "drivers/transport/transport_error.hpp"
#include "tools/sensors/places.hpp"
#include "tools/sensors/remarks.hpp"

namespace slamd::sensors {

namespace {

constexpr int kMostAtOnce = 512;  // whatever floods the network, others have their turn

using Kind = UdpPlace::Kind;

struct KnownPort {
  std::uint16_t port;
  const char* purpose;
  Kind kind;
};

/// Where sensors speak that are set as they come, or as slamd sets them.
constexpr KnownPort kPorts[] = {
    {2368, "points of a Velodyne", Kind::kData},
    {8308, "position packets of a Velodyne", Kind::kData},
    {56001, "points and inertial samples of an Avia", Kind::kData},
    {56201, "the state of a Mid-360", Kind::kData},
    {56301, "points of a Mid-360", Kind::kData},
    {56401, "inertial samples of a Mid-360", Kind::kData},
    {7501, "inertial samples as rows of CSV", Kind::kData},
    {livox::Sdk1Host::kBroadcastPort, "broadcasts of Livox SDK1 devices", Kind::kBroadcasts},
    {livox::Sdk2Host::kDiscoveryPort, "other hosts' searches for Livox SDK2 devices", Kind::kAnswers},
};

}  // namespace

void add_places_of(const configuration::Configuration& configuration, ListeningConfig& listening) {
  const configuration::LidarConfiguration& lidar = configuration.lidar;
  const bool is_spinning = !configuration::is_livox(lidar.model);
  for (const int port : {lidar.listening_port(), is_spinning ? lidar.position_port : lidar.imu_port}) {
    listening.ports.push_back(static_cast<std::uint16_t>(port));
  }
  if (configuration.imu.enabled && configuration.imu.source == "udp") {
    listening.ports.push_back(static_cast<std::uint16_t>(configuration.imu.port));
  }
  const auto add = [](bool is_meant, const std::string& name, std::vector<std::string>& names) {
    if (is_meant) {
      names.insert(names.begin(), name);
    }
  };
  add(configuration.imu.enabled && configuration.imu.source == "serial", configuration.imu.device, listening.serial);
  add(configuration.gnss.is_serial(), configuration.gnss.device, listening.serial);
  add(configuration.imu.enabled && configuration.imu.source == "can", configuration.imu.interface, listening.can);
  add(configuration.wheel.use && configuration.wheel.source == "can", configuration.wheel.interface, listening.can);
}

Listening::Listening(const ListeningConfig& config, const transport::HostClock& clock)
    : config_(config), clock_(clock), began_(clock.now()), interfaces_(transport::interfaces()) {
  for (const KnownPort& known : kPorts) {
    ports_.push_back(std::make_unique<UdpPlace>(known.port, known.purpose, known.kind, clock_));
  }
  searching_ = ports_.back().get();
  if (!searching_->is_open()) {
    // What is answered to that port belongs to whoever has it; devices answer to the port that asks.
    ports_.push_back(std::make_unique<UdpPlace>(0, "answers of Livox SDK2 devices", Kind::kBroadcasts, clock_));
    searching_ = ports_.back().get();
  }
  for (const std::uint16_t port : config_.ports) {
    if (std::none_of(ports_.begin(), ports_.end(), [&](const auto& place) { return place->port() == port; })) {
      ports_.push_back(std::make_unique<UdpPlace>(port, "packets", Kind::kData, clock_));
    }
  }
  try {
    wire_ = std::make_unique<transport::WireListener>();
  } catch (const transport::TransportError&) {
    // seen() says so
  }
  for (const std::uint32_t address : config_.avias) {
    avias_.emplace_back(address);
  }
  find_places();
  search();
}

void Listening::find_places() {
  std::vector<std::string> serial = config_.serial;
  if (config_.finds_serial) {
    const std::vector<std::string> adapters = serial_adapters();
    serial.insert(serial.end(), adapters.begin(), adapters.end());
  }
  for (const std::string& device : serial) {
    if (std::none_of(lines_.begin(), lines_.end(), [&](const auto& line) { return is_same_device(line->device(), device); })) {
      lines_.push_back(std::make_unique<SerialPlace>(device, config_.asks, clock_.now()));
    }
  }
  std::vector<std::string> can = config_.can;
  const std::vector<std::string> interfaces = can_interfaces();
  can.insert(can.end(), interfaces.begin(), interfaces.end());
  for (const std::string& interface : can) {
    if (std::none_of(buses_.begin(), buses_.end(), [&](const auto& bus) { return bus->interface() == interface; })) {
      buses_.push_back(std::make_unique<BusPlace>(interface, clock_));
    }
  }
}

/// As every host of SDK2 devices does, once a second; and, where that is allowed, what those are set to that were found.
void Listening::search() {
  const auto write = [&](livox::Sdk2Command command, std::span<const std::byte> payload) {
    return livox::write_sdk2_frame({++questions_, command, false, false, payload});
  };
  searching_->send(write(livox::Sdk2Command::kDiscovery, {}).view(), transport::kBroadcastAddress, livox::Sdk2Host::kDiscoveryPort);
  if (config_.asks) {
    for (const livox::Endpoint& device : network_.sdk2_devices()) {
      const livox::Payload question = livox::sdk2_question(livox::kSdk2StateKeys);
      searching_->send(write(livox::Sdk2Command::kGetParameters, question.view()).view(), device.address, device.port);
    }
  }
}

void Listening::ask_avias() {
  if (avias_.empty()) {
    return;
  }
  // A program that keeps an Avia hears these broadcasts. A handshake in this host's name would take its device away.
  const std::string host = transport::other_owner_of_port(livox::Sdk1Host::kBroadcastPort);
  hindrance_ = host.empty() ? "" : host + " on this computer looks for such devices, and may have it";
  if (!hindrance_.empty()) {
    return;
  }
  if (!avia_socket_) {
    avia_socket_ = std::make_unique<transport::DatagramSocket>(0);
  }
  for (AviaQuestion& avia : avias_) {
    for (const transport::Interface& interface : interfaces_) {
      if (is_in_own_subnet(avia.address(), {interface})) {
        send_to_avia(avia.question(interface.address, avia_socket_->port()), avia.address());
        break;
      }
    }
  }
}

void Listening::send_to_avia(const livox::FrameBytes& bytes, std::uint32_t address) {
  if (!bytes.empty()) {
    avia_socket_->send(bytes.view(), address, AviaQuestion::kDevicePort);
  }
}

void Listening::hear_avias() {
  for (int i = 0; avia_socket_ && i < kMostAtOnce; ++i) {
    const auto datagram = avia_socket_->receive();
    if (!datagram) {
      return;
    }
    for (AviaQuestion& avia : avias_) {
      if (avia.address() == datagram->address) {
        send_to_avia(avia.take(datagram->payload), avia.address());
      }
    }
  }
}

/// What comes from this host's own subnets the kernel delivers to the ports.
void Listening::hear_wire() {
  for (int i = 0; wire_ && i < kMostAtOnce; ++i) {
    const auto datagram = wire_->receive();
    if (!datagram) {
      return;
    }
    if (!is_in_own_subnet(datagram->source_address, interfaces_)) {
      beyond_.take({datagram->payload, datagram->source_address, datagram->destination_port, clock_.now()}, interfaces_);
    }
  }
}

void Listening::run_once(Duration longest) {
  std::vector<pollfd> entries;
  const auto add = [&](int fd) {
    if (fd >= 0) {
      entries.push_back({fd, POLLIN, 0});
    }
  };
  for (const auto& port : ports_) {
    add(port->fd());
  }
  for (const auto& line : lines_) {
    add(line->fd());
  }
  for (const auto& bus : buses_) {
    add(bus->fd());
  }
  add(wire_ ? wire_->fd() : -1);
  add(avia_socket_ ? avia_socket_->fd() : -1);
  poll(entries.data(), entries.size(), static_cast<int>(std::chrono::duration_cast<std::chrono::milliseconds>(longest).count()));
  for (const auto& port : ports_) {
    port->run_once(network_, interfaces_);
  }
  hear_wire();
  hear_avias();
  for (const auto& line : lines_) {
    line->run_once(clock_.now());
  }
  for (const auto& bus : buses_) {
    bus->run_once();
  }
}

void Listening::end_second() {
  interfaces_ = transport::interfaces();
  network_.end_second();
  beyond_.end_second();
  for (const auto& port : ports_) {
    port->end_second();
    port->attend();
  }
  for (const auto& line : lines_) {
    line->end_second();
  }
  for (const auto& bus : buses_) {
    bus->end_second();
    bus->attend();
  }
  find_places();
  search();
  ask_avias();
}

Seen Listening::seen() const {
  Seen seen;
  seen.listened_s = to_seconds(clock_.now() - began_);
  seen.asked = config_.asks;
  seen.interfaces = interfaces_;
  for (const auto& port : ports_) {
    seen.ports.push_back(port->seen());
  }
  network_.show(clock_.now(), seen);
  beyond_.show(clock_.now(), seen);
  seen.hears_wire = wire_ != nullptr;
  for (const AviaQuestion& avia : avias_) {
    const bool is_reached = is_in_own_subnet(avia.address(), interfaces_);
    seen.avias.push_back({avia.address(), avia.answer(), !is_reached           ? "it is of another subnet than this host"
                                                                 : hindrance_.empty() ? "there was no time yet"
                                                                                      : hindrance_});
  }
  for (const auto& line : lines_) {
    seen.lines.push_back(line->seen());
  }
  for (const auto& bus : buses_) {
    seen.buses.push_back(bus->seen());
  }
  return seen;
}

}  // namespace slamd::sensors
