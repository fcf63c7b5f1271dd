#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd::transport {

/// A datagram as it was on the wire. Addresses in host order.
struct WireDatagram {
  std::span<const std::byte> payload;
  std::uint32_t source_address = 0;
  std::uint32_t destination_address = 0;
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
};

/// What an IPv4 packet turned out to be.
enum class Ipv4Kind : std::uint8_t {
  kUdp,
  kNotUdp,
  kFragment,   // part of a fragmented datagram
  kTruncated,  // fewer bytes than the headers say
  kBadHeader,  // lengths contradict each other
};

/// Finds the UDP datagram in an IPv4 packet, and fills `datagram` when there is one. Any bytes may be given.
/// `length` is that of the packet on the wire. An IP length beyond it is passed over when the UDP length fits: early VLP-16
/// firmware states the length of its data packets for its position packets, too.
/// Source: RFC 791, RFC 768.  Real-time: no allocation.
Ipv4Kind parse_ipv4(std::span<const std::byte> ip, std::size_t length, WireDatagram& datagram);

}  // namespace slamd::transport
