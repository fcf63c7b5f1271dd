#include "drivers/transport/datagram_socket.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/transport/interfaces.hpp"
#include "drivers/transport/port_owner.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::transport {

namespace {

[[noreturn]] void fail(std::uint16_t port, int error) {
  const std::string cause = error == EADDRINUSE ? taken_in_words(port) : "cannot be bound: " + std::generic_category().message(error);
  throw TransportError("UDP port " + std::to_string(port) + " " + cause);
}

sockaddr_in socket_address(std::uint32_t address, std::uint16_t port) {
  sockaddr_in made{};
  made.sin_family = AF_INET;
  made.sin_port = htons(port);
  made.sin_addr.s_addr = htonl(address);
  return made;
}

}  // namespace

DatagramSocket::DatagramSocket(std::uint16_t port, Sharing sharing)
    : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  const int on = 1;
  sockaddr_in bound = socket_address(INADDR_ANY, port);
  socklen_t length = sizeof bound;
  const bool ready =
      fd_ >= 0 && setsockopt(fd_, SOL_SOCKET, SO_BROADCAST, &on, sizeof on) == 0 &&
      (sharing == Sharing::kAlone || setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0) &&
      bind(fd_, reinterpret_cast<const sockaddr*>(&bound), length) == 0 &&
      getsockname(fd_, reinterpret_cast<sockaddr*>(&bound), &length) == 0;
  if (!ready) {
    const int error = errno;
    close(fd_);
    fail(port, error);
  }
  port_ = ntohs(bound.sin_port);
}

DatagramSocket::~DatagramSocket() { close(fd_); }

std::optional<DatagramSocket::Received> DatagramSocket::receive() {
  sockaddr_in from{};
  socklen_t length = sizeof from;
  const ssize_t size = recvfrom(fd_, buffer_.data(), buffer_.size(), 0, reinterpret_cast<sockaddr*>(&from), &length);
  if (size < 0) {
    return std::nullopt;
  }
  return Received{std::span(buffer_).first(static_cast<std::size_t>(size)), ntohl(from.sin_addr.s_addr),
                  ntohs(from.sin_port)};
}

bool DatagramSocket::send(std::span<const std::byte> payload, std::uint32_t address, std::uint16_t port) {
  if (address != kBroadcastAddress) {
    const sockaddr_in to = socket_address(address, port);
    return sendto(fd_, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) >= 0;
  }
  bool sent = false;
  for (const Interface& interface : interfaces()) {
    sent = (interface.broadcasts && send_by(interface.index, payload, address, port)) || sent;
  }
  return sent;
}

/// Names the interface, for there need be no route to everybody.
bool DatagramSocket::send_by(unsigned interface_index, std::span<const std::byte> payload, std::uint32_t address,
                             std::uint16_t port) {
  sockaddr_in to = socket_address(address, port);
  iovec part{const_cast<std::byte*>(payload.data()), payload.size()};
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(in_pktinfo))> control{};
  msghdr message{};
  message.msg_name = &to;
  message.msg_namelen = sizeof to;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  cmsghdr* const header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = IPPROTO_IP;
  header->cmsg_type = IP_PKTINFO;
  header->cmsg_len = CMSG_LEN(sizeof(in_pktinfo));
  in_pktinfo info{};
  info.ipi_ifindex = static_cast<int>(interface_index);
  std::memcpy(CMSG_DATA(header), &info, sizeof info);
  return sendmsg(fd_, &message, 0) >= 0;
}

}  // namespace slamd::transport
