#include "drivers/transport/wire_listener.hpp"

#include <cerrno>
#include <string>
#include <system_error>

#include <linux/filter.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/bytes.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::transport {

namespace {

// Of an IPv4 header, RFC 791, and a UDP header, RFC 768.
constexpr std::size_t kIpBytes = 20;
constexpr std::size_t kTotalLengthAt = 2;
constexpr std::size_t kFragmentAt = 6;
constexpr std::uint16_t kFragmentBits = 0x3FFF;  // more fragments, or an offset
constexpr std::size_t kProtocolAt = 9;
constexpr std::size_t kSourceAt = 12;
constexpr std::size_t kDestinationAt = 16;
constexpr std::size_t kUdpBytes = 8;

/// Has the kernel hand on nothing but UDP.
bool keep_udp_only(int fd) {
  sock_filter program[] = {
      {BPF_LD | BPF_B | BPF_ABS, 0, 0, kProtocolAt},
      {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, IPPROTO_UDP},
      {BPF_RET | BPF_K, 0, 0, 0xFFFF},
      {BPF_RET | BPF_K, 0, 0, 0},
  };
  const sock_fprog filter{static_cast<unsigned short>(std::size(program)), program};
  return setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) == 0;
}

}  // namespace

std::optional<WireDatagram> parse_udp(std::span<const std::byte> packet) {
  if (packet.size() < kIpBytes + kUdpBytes) {
    return std::nullopt;
  }
  const auto version_and_words = load_be<std::uint8_t>(packet, 0);
  const std::size_t header_bytes = std::size_t{version_and_words & 0x0FU} * 4;
  const std::size_t total_bytes = load_be<std::uint16_t>(packet, kTotalLengthAt);
  if (version_and_words >> 4U != 4 || header_bytes < kIpBytes || total_bytes > packet.size() ||
      header_bytes + kUdpBytes > total_bytes || load_be<std::uint8_t>(packet, kProtocolAt) != IPPROTO_UDP ||
      (load_be<std::uint16_t>(packet, kFragmentAt) & kFragmentBits) != 0) {
    return std::nullopt;
  }
  const std::span<const std::byte> udp = packet.subspan(header_bytes, total_bytes - header_bytes);
  const std::size_t udp_bytes = load_be<std::uint16_t>(udp, 4);
  if (udp_bytes < kUdpBytes || udp_bytes > udp.size()) {
    return std::nullopt;
  }
  return WireDatagram{udp.subspan(kUdpBytes, udp_bytes - kUdpBytes), load_be<std::uint32_t>(packet, kSourceAt),
                      load_be<std::uint32_t>(packet, kDestinationAt), load_be<std::uint16_t>(udp, 0),
                      load_be<std::uint16_t>(udp, 2)};
}

WireListener::WireListener() : fd_(socket(AF_PACKET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, htons(ETH_P_IP))) {
  if (fd_ < 0 || !keep_udp_only(fd_)) {
    const int error = errno;
    if (fd_ >= 0) {
      close(fd_);
    }
    throw TransportError("the wire cannot be listened to: " + std::generic_category().message(error));
  }
}

WireListener::~WireListener() { close(fd_); }

std::optional<WireDatagram> WireListener::receive() {
  sockaddr_ll from{};
  socklen_t length = sizeof from;
  while (true) {
    const ssize_t size = recvfrom(fd_, buffer_.data(), buffer_.size(), 0, reinterpret_cast<sockaddr*>(&from), &length);
    if (size < 0) {
      return std::nullopt;
    }
    if (from.sll_pkttype == PACKET_OUTGOING) {
      continue;
    }
    if (const auto datagram = parse_udp(std::span(buffer_).first(static_cast<std::size_t>(size)))) {
      return datagram;
    }
  }
}

}  // namespace slamd::transport
