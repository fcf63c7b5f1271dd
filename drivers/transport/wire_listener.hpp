#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/transport/ipv4.hpp"

namespace slamd::transport {

/// Finds the UDP datagram in a whole IPv4 packet (parse_ipv4). Errors: nothing for another protocol, for a fragment, and for
/// lengths that contradict each other. Any bytes may be given.
std::optional<WireDatagram> parse_udp(std::span<const std::byte> packet);

/// Hears the UDP datagrams that come in on any interface before the kernel judges whether they are this host's: also those
/// of a sensor in a subnet to which there is no route, which the kernel drops wherever it checks return paths (rp_filter, as
/// systemd sets it). Takes none from whoever they are meant for.
/// Threads: one.  Real-time: no; never blocks.
class WireListener {
 public:
  /// Errors: TransportError: no permission (CAP_NET_RAW).
  WireListener();
  ~WireListener();
  WireListener(const WireListener&) = delete;
  WireListener& operator=(const WireListener&) = delete;

  /// Takes the next datagram that waits; nothing when none does. Valid until the next call.
  std::optional<WireDatagram> receive();

  int fd() const { return fd_; }

 private:
  int fd_ = -1;
  std::array<std::byte, 2048> buffer_{};
};

}  // namespace slamd::transport
