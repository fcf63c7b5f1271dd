#include "drivers/transport/udp_receiver.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "drivers/transport/port_owner.hpp"

namespace slamd::transport {

namespace {

std::string words_of(int error) { return std::generic_category().message(error); }

[[noreturn]] void fail(std::uint16_t port, const std::string& cause) {
  throw TransportError("UDP port " + std::to_string(port) + " " + cause);
}

[[noreturn]] void fail_to_bind(const UdpReceiverConfig& config, int error) {
  switch (error) {
    case EADDRINUSE: fail(config.port, taken_in_words(config.port));
    case EADDRNOTAVAIL: fail(config.port, "cannot be bound: no interface of this host has the address " + config.bind_address);
    case EACCES: fail(config.port, "cannot be bound: no permission (ports below 1024 need CAP_NET_BIND_SERVICE)");
    default: fail(config.port, "cannot be bound to " + config.bind_address + ": " + words_of(error));
  }
}

}  // namespace

/// The memory that recvmmsg fills.
struct UdpReceiver::Batch {
  struct Slot {
    std::array<std::byte, kMaxPayloadBytes> payload;
    alignas(cmsghdr) std::array<std::byte, Receipts::kControlBytes> control;
    sockaddr_in source;
    iovec part;
  };

  Batch() {
    for (std::size_t i = 0; i < kBatch; ++i) {
      slots[i].part = {slots[i].payload.data(), slots[i].payload.size()};
    }
  }

  /// Undoes what the last call has written into the headers.
  void rearm() {
    for (std::size_t i = 0; i < kBatch; ++i) {
      msghdr& header = messages[i].msg_hdr;
      header = {};
      header.msg_name = &slots[i].source;
      header.msg_namelen = sizeof slots[i].source;
      header.msg_iov = &slots[i].part;
      header.msg_iovlen = 1;
      header.msg_control = slots[i].control.data();
      header.msg_controllen = slots[i].control.size();
    }
  }

  std::array<Slot, kBatch> slots{};
  std::array<mmsghdr, kBatch> messages{};
};

UdpReceiver::UdpReceiver(const UdpReceiverConfig& config, const HostClock& clock)
    : receipts_(clock), batch_(std::make_unique<Batch>()) {
  if (!config.source_address.empty()) {
    source_ = parse_address(config.source_address);
    source_is_configured_ = true;
    if (!source_) {
      fail(config.port, "cannot listen to \"" + config.source_address + "\": no IPv4 address");
    }
  }
  try {
    open_socket(config);
  } catch (...) {
    close(fd_);
    throw;
  }
}

UdpReceiver::~UdpReceiver() { close(fd_); }

void UdpReceiver::open_socket(const UdpReceiverConfig& config) {
  const std::optional<std::uint32_t> address = parse_address(config.bind_address);
  if (!address) {
    fail(config.port, "cannot be bound to \"" + config.bind_address + "\": no IPv4 address");
  }
  fd_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd_ < 0) {
    fail(config.port, "cannot be opened: " + words_of(errno));
  }
  if (const int error = receipts_.set_up(fd_, config.receive_buffer_bytes); error != 0) {
    fail(config.port, "has no receive stamps or loss counts: " + words_of(error));
  }
  sockaddr_in bound{};
  bound.sin_family = AF_INET;
  bound.sin_port = htons(config.port);
  bound.sin_addr.s_addr = htonl(*address);
  if (bind(fd_, reinterpret_cast<const sockaddr*>(&bound), sizeof bound) != 0) {
    fail_to_bind(config, errno);
  }
  socklen_t length = sizeof bound;
  getsockname(fd_, reinterpret_cast<sockaddr*>(&bound), &length);
  port_ = ntohs(bound.sin_port);
}

std::size_t UdpReceiver::take_batch() {
  batch_->rearm();
  return receipts_.receive(fd_, batch_->messages);
}

bool UdpReceiver::open(std::size_t index, Datagram& datagram) {
  const Batch::Slot& slot = batch_->slots[index];
  mmsghdr& message = batch_->messages[index];
  const Stamp received = receipts_.read(message.msg_hdr);
  datagram.source_address = ntohl(slot.source.sin_addr.s_addr);
  if (source_ && datagram.source_address != *source_) {
    foreign_source_.add();
    return false;
  }
  if ((message.msg_hdr.msg_flags & MSG_TRUNC) != 0) {
    truncated_.add();
    return false;
  }
  datagram.payload = std::span(slot.payload).first(message.msg_len);
  datagram.received = received;
  datagram.source_port = ntohs(slot.source.sin_port);
  datagram.destination_port = port_;
  received_.add();
  return true;
}

void UdpReceiver::pin(std::uint32_t source_address) {
  if (!source_is_configured_) {
    source_ = source_address;
  }
}

void UdpReceiver::unpin() {
  if (!source_is_configured_) {
    source_.reset();
  }
}

std::string UdpReceiver::buffer_remark() const { return receipts_.buffer_remark("UDP port " + std::to_string(port_)); }

UdpCounters UdpReceiver::counters() const {
  return {received_.value(), foreign_source_.value(), truncated_.value(), receipts_.lost()};
}

std::optional<std::uint32_t> parse_address(const std::string& dotted) {
  in_addr address{};
  if (inet_pton(AF_INET, dotted.c_str(), &address) != 1) {
    return std::nullopt;
  }
  return ntohl(address.s_addr);
}

std::string dotted(std::uint32_t address) {
  return std::to_string(address >> 24) + "." + std::to_string(address >> 16 & 0xFFU) + "." +
         std::to_string(address >> 8 & 0xFFU) + "." + std::to_string(address & 0xFFU);
}

}  // namespace slamd::transport
