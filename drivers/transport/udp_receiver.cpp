#include "drivers/transport/udp_receiver.hpp"

#include <arpa/inet.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
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
    case EADDRINUSE: {
      const std::string owner = udp_port_owner(config.port);
      fail(config.port, "is taken" + (owner.empty() ? " by another process" : " by " + owner));
    }
    case EADDRNOTAVAIL: fail(config.port, "cannot be bound: no interface of this host has the address " + config.bind_address);
    case EACCES: fail(config.port, "cannot be bound: no permission (ports below 1024 need CAP_NET_BIND_SERVICE)");
    default: fail(config.port, "cannot be bound to " + config.bind_address + ": " + words_of(error));
  }
}

bool set_option(int fd, int name, int value) { return setsockopt(fd, SOL_SOCKET, name, &value, sizeof value) == 0; }

}  // namespace

/// The memory that recvmmsg fills.
struct UdpReceiver::Batch {
  struct Slot {
    std::array<std::byte, kMaxPayloadBytes> payload;
    alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof(std::timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> control;
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
    : clock_(clock), wanted_bytes_(config.receive_buffer_bytes), batch_(std::make_unique<Batch>()) {
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
  if (!set_option(fd_, SO_RCVBUFFORCE, wanted_bytes_)) {  // root's; others are cut to net.core.rmem_max
    set_option(fd_, SO_RCVBUF, wanted_bytes_);
  }
  socklen_t length = sizeof granted_bytes_;
  getsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &granted_bytes_, &length);
  granted_bytes_ /= 2;  // the kernel doubles what is asked for, to have room for its own
  if (!set_option(fd_, SO_TIMESTAMPNS, 1) || !set_option(fd_, SO_RXQ_OVFL, 1)) {
    fail(config.port, "has no receive stamps or loss counts: " + words_of(errno));
  }
  sockaddr_in bound{};
  bound.sin_family = AF_INET;
  bound.sin_port = htons(config.port);
  bound.sin_addr.s_addr = htonl(*address);
  if (bind(fd_, reinterpret_cast<const sockaddr*>(&bound), sizeof bound) != 0) {
    fail_to_bind(config, errno);
  }
  length = sizeof bound;
  getsockname(fd_, reinterpret_cast<sockaddr*>(&bound), &length);
  port_ = ntohs(bound.sin_port);
}

std::size_t UdpReceiver::take_batch() {
  batch_->rearm();
  const int taken = recvmmsg(fd_, batch_->messages.data(), kBatch, MSG_DONTWAIT, nullptr);
  if (taken < static_cast<int>(kBatch)) {
    read_losses();  // those after the newest datagram, too
  }
  if (taken <= 0) {
    return 0;
  }
  readings_ = clock_.read();
  return static_cast<std::size_t>(taken);
}

bool UdpReceiver::open(std::size_t index, Datagram& datagram) {
  const Batch::Slot& slot = batch_->slots[index];
  mmsghdr& message = batch_->messages[index];
  const Stamp now = clock_.from_monotonic(readings_.monotonic);
  Stamp received = now;
  for (cmsghdr* control = CMSG_FIRSTHDR(&message.msg_hdr); control != nullptr;
       control = CMSG_NXTHDR(&message.msg_hdr, control)) {
    if (control->cmsg_level != SOL_SOCKET) {
      continue;
    }
    if (control->cmsg_type == SO_TIMESTAMPNS) {
      std::timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(control), sizeof stamp);
      received = clock_.from_realtime(std::chrono::seconds(stamp.tv_sec) + Duration(stamp.tv_nsec), readings_);
    } else if (control->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t losses = 0;
      std::memcpy(&losses, CMSG_DATA(control), sizeof losses);
      note_losses(losses);
    }
  }
  // A datagram that arrived right before the wall clock stepped is converted by the difference from after the step;
  // but it did arrive between the one before and now.
  received = std::min(std::max(received, last_received_), now);
  last_received_ = received;
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

void UdpReceiver::note_losses(std::uint32_t kernel_count) {
  const auto more = static_cast<std::int32_t>(kernel_count - kernel_count_);
  if (more > 0) {  // a datagram tells the count from when it was queued, which may be older news
    kernel_lost_.add(static_cast<std::uint64_t>(more));
    kernel_count_ = kernel_count;
  }
}

void UdpReceiver::read_losses() {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t length = sizeof memory;
  if (getsockopt(fd_, SOL_SOCKET, SO_MEMINFO, memory.data(), &length) == 0 &&
      length >= (SK_MEMINFO_DROPS + 1) * sizeof(std::uint32_t)) {
    note_losses(memory[SK_MEMINFO_DROPS]);
  }
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

std::string UdpReceiver::buffer_remark() const {
  if (granted_bytes_ >= wanted_bytes_) {
    return "";
  }
  return "UDP port " + std::to_string(port_) + ": receive buffer of " + std::to_string(granted_bytes_) + " bytes instead of " +
         std::to_string(wanted_bytes_) + " (sysctl net.core.rmem_max=" + std::to_string(wanted_bytes_) +
         ", or CAP_NET_ADMIN, gives it the rest)";
}

UdpCounters UdpReceiver::counters() const {
  return {received_.value(), foreign_source_.value(), truncated_.value(), kernel_lost_.value()};
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
