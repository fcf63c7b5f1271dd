#include "tools/replay/can_sender.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace slamd::replay {

namespace {

[[noreturn]] void fail(const std::string& interface, const std::string& what, int error) {
  throw std::runtime_error("CAN interface " + interface + ": " + what + ": " + std::generic_category().message(error));
}

}  // namespace

CanSender::CanSender(const std::string& interface) : interface_(interface), fd_(socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
  if (fd_ < 0) {
    fail(interface_, "no CAN socket to be had", errno);
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  // Without a filter nothing is received, which nobody here would read.
  if (address.can_ifindex == 0 || setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0) != 0 ||
      bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int error = errno;
    close(fd_);
    fail(interface_, "cannot be sent to", error);
  }
}

CanSender::~CanSender() { close(fd_); }

void CanSender::send(const transport::CanFrame& frame, SendClock& clock) {
  can_frame raw{};
  raw.can_id = frame.id | (frame.is_extended ? CAN_EFF_FLAG : 0U);
  raw.can_dlc = frame.size;
  std::memcpy(raw.data, frame.data.data(), frame.size);
  while (write(fd_, &raw, sizeof raw) != static_cast<ssize_t>(sizeof raw)) {
    if (errno == ENOBUFS) {
      clock.sleep_until(clock.now() + kBurstPause);
    } else if (errno != EINTR) {
      fail(interface_, "cannot be sent to", errno);
    }
  }
}

void CanFrames::advance() {
  transport::CanFrame frame;
  next_ = reader_.next(frame) ? std::optional(frame) : std::nullopt;
}

std::uint64_t CanFrames::skip_until(Stamp stamp) {
  std::uint64_t count = 0;
  for (; next_ && next_->received < stamp; advance()) {
    ++count;
  }
  return count;
}

std::uint64_t CanFrames::send_until(Stamp until, NetworkPlayer& player) {
  std::uint64_t count = 0;
  for (; next_ && next_->received <= until && player.wait_until(next_->received); advance()) {
    sender_.send(*next_, clock_);
    ++count;
  }
  return count;
}

}  // namespace slamd::replay
