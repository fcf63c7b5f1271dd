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

// Of an IPv4 header, RFC 791.
constexpr std::size_t kTotalLengthAt = 2;
constexpr std::size_t kProtocolAt = 9;

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
  WireDatagram datagram;
  const bool is_whole = packet.size() >= kTotalLengthAt + 2 && load_be<std::uint16_t>(packet, kTotalLengthAt) <= packet.size();
  return is_whole && parse_ipv4(packet, packet.size(), datagram) == Ipv4Kind::kUdp ? std::optional(datagram) : std::nullopt;
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
