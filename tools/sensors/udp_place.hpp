#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/transport/datagram_socket.hpp"
#include "drivers/transport/host_clock.hpp"
#include "drivers/transport/udp_receiver.hpp"
#include "tools/sensors/network_watch.hpp"

namespace slamd::sensors {

/// Listens at one UDP port, if nobody else has it, and says who does.
/// Threads: one.
class UdpPlace {
 public:
  enum class Kind {
    kData,       // alone: packets of points and samples, which are many
    kBroadcasts, // with others: what is said to everybody comes to each of them
    kAnswers,    // with others, but only where nobody listens yet: what is said to one comes to the last that has bound it
  };

  UdpPlace(std::uint16_t port, std::string purpose, Kind kind, const transport::HostClock& clock);

  /// Binds the port if it is free by now.
  void attend();

  /// Hands what waits to `network`; own: this host's addresses.
  void run_once(NetworkWatch& network, std::span<const transport::Interface> own);

  /// Sends from this port; false: it is not bound, or the network does not take it.
  bool send(std::span<const std::byte> payload, std::uint32_t address, std::uint16_t port);

  void end_second();

  bool is_open() const { return data_ || datagrams_; }
  int fd() const { return data_ ? data_->fd() : datagrams_ ? datagrams_->fd() : -1; }
  std::uint16_t port() const { return seen_.port; }
  PortSeen seen() const;

 private:
  void take(const Arrival& arrival, NetworkWatch& network, std::span<const transport::Interface> own);

  PortSeen seen_;
  Kind kind_;
  transport::HostClock clock_;
  std::unique_ptr<transport::UdpReceiver> data_;
  std::unique_ptr<transport::DatagramSocket> datagrams_;
  SecondCount count_;
  SecondCount strange_;
};

}  // namespace slamd::sensors
