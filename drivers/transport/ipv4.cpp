#include "drivers/transport/ipv4.hpp"

#include <algorithm>

#include "core/base/bytes.hpp"

namespace slamd::transport {

namespace {

constexpr std::uint8_t kProtocolUdp = 17;

}  // namespace

Ipv4Kind parse_ipv4(std::span<const std::byte> ip, std::size_t length, WireDatagram& datagram) {
  if (ip.size() < 20) {
    return length < 20 ? Ipv4Kind::kBadHeader : Ipv4Kind::kTruncated;
  }
  const std::size_t header = 4 * (static_cast<std::size_t>(ip[0]) & 0xF);
  const std::size_t total = load_be<std::uint16_t>(ip, 2);
  if (static_cast<int>(ip[0]) >> 4 != 4 || header < 20 || total < header) {
    return Ipv4Kind::kBadHeader;
  }
  const std::size_t end = std::min(total, length);
  if (static_cast<std::uint8_t>(ip[9]) != kProtocolUdp) {
    return Ipv4Kind::kNotUdp;
  }
  if ((load_be<std::uint16_t>(ip, 6) & 0x3FFF) != 0) {  // more fragments, or an offset
    return Ipv4Kind::kFragment;
  }
  if (end < header + 8) {
    return Ipv4Kind::kBadHeader;
  }
  if (ip.size() < header + 8) {
    return Ipv4Kind::kTruncated;
  }
  const std::span<const std::byte> udp = ip.subspan(header);
  const std::size_t udp_length = load_be<std::uint16_t>(udp, 4);
  if (udp_length < 8 || header + udp_length > end) {
    return Ipv4Kind::kBadHeader;
  }
  if (udp.size() < udp_length) {
    return Ipv4Kind::kTruncated;
  }
  datagram.source_address = load_be<std::uint32_t>(ip, 12);
  datagram.destination_address = load_be<std::uint32_t>(ip, 16);
  datagram.source_port = load_be<std::uint16_t>(udp, 0);
  datagram.destination_port = load_be<std::uint16_t>(udp, 2);
  datagram.payload = udp.subspan(8, udp_length - 8);
  return Ipv4Kind::kUdp;
}

}  // namespace slamd::transport
