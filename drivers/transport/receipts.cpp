#include "drivers/transport/receipts.hpp"

#include <linux/sock_diag.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace slamd::transport {

namespace {

bool set_option(int fd, int name, int value) { return setsockopt(fd, SOL_SOCKET, name, &value, sizeof value) == 0; }

}  // namespace

int Receipts::set_up(int fd, int wanted_bytes) {
  wanted_bytes_ = wanted_bytes;
  if (!set_option(fd, SO_RCVBUFFORCE, wanted_bytes)) {  // root's; others are cut to net.core.rmem_max
    set_option(fd, SO_RCVBUF, wanted_bytes);
  }
  socklen_t length = sizeof granted_bytes_;
  getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted_bytes_, &length);
  granted_bytes_ /= 2;  // the kernel doubles what is asked for, to have room for its own
  return set_option(fd, SO_TIMESTAMPNS, 1) && set_option(fd, SO_RXQ_OVFL, 1) ? 0 : errno;
}

std::size_t Receipts::receive(int fd, std::span<mmsghdr> messages) {
  const int taken = recvmmsg(fd, messages.data(), static_cast<unsigned>(messages.size()), MSG_DONTWAIT, nullptr);
  if (taken < static_cast<int>(messages.size())) {
    read_losses(fd);
  }
  if (taken <= 0) {
    return 0;
  }
  readings_ = clock_.read();
  return static_cast<std::size_t>(taken);
}

std::string Receipts::buffer_remark(const std::string& whose) const {
  if (granted_bytes_ >= wanted_bytes_) {
    return "";
  }
  const std::string wanted = std::to_string(wanted_bytes_);
  return whose + ": receive buffer of " + std::to_string(granted_bytes_) + " bytes instead of " + wanted +
         " (sysctl net.core.rmem_max=" + wanted + ", or CAP_NET_ADMIN, gives it the rest)";
}

Stamp Receipts::read(msghdr& header) {
  const Stamp now = clock_.from_monotonic(readings_.monotonic);
  Stamp received = now;
  for (cmsghdr* control = CMSG_FIRSTHDR(&header); control != nullptr; control = CMSG_NXTHDR(&header, control)) {
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
  // A message that arrived right before the wall clock stepped is converted by the difference from after the step;
  // but it did arrive between the one before and now.
  last_received_ = std::min(std::max(received, last_received_), now);
  return last_received_;
}

void Receipts::note_losses(std::uint32_t kernel_count) {
  const auto more = static_cast<std::int32_t>(kernel_count - kernel_count_);
  if (more > 0) {  // a message tells the count from when it was queued, which may be older news
    lost_.add(static_cast<std::uint64_t>(more));
    kernel_count_ = kernel_count;
  }
}

void Receipts::read_losses(int fd) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t length = sizeof memory;
  if (getsockopt(fd, SOL_SOCKET, SO_MEMINFO, memory.data(), &length) == 0 &&
      length >= (SK_MEMINFO_DROPS + 1) * sizeof(std::uint32_t)) {
    note_losses(memory[SK_MEMINFO_DROPS]);
  }
}

}  // namespace slamd::transport
