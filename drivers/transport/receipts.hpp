#pragma once

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <span>
#include <string>

#include <sys/socket.h>

#include "core/base/counter.hpp"
#include "core/base/stamp.hpp"
#include "drivers/transport/host_clock.hpp"

namespace slamd::transport {

/// What the kernel says of the messages that a socket receives: when each came in, and how many were lost before.
///
/// A stamp never lies before the one of the message before, nor in the future, even while the wall clock steps.
/// Threads: one receives; lost() is for any.  Real-time: never allocates, never blocks.
class Receipts {
 public:
  /// Of a message's control buffer, which must be aligned as a cmsghdr.
  static constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(std::timespec)) + CMSG_SPACE(sizeof(std::uint32_t));

  explicit Receipts(const HostClock& clock) : clock_(clock) {}

  /// Asks for stamps, loss counts and a receive buffer of so many bytes. Returns 0, or an errno.
  int set_up(int fd, int wanted_bytes);

  /// The receive buffer that the kernel has granted, in the unit of `wanted_bytes`.
  int granted_bytes() const { return granted_bytes_; }

  /// Takes the waiting messages, as many as there is room for, and returns how many: 0 when none was waiting. Where they
  /// were all, takes note of losses after the newest one, too.
  std::size_t receive(int fd, std::span<mmsghdr> messages);

  /// Returns when a message of the last batch came in, and takes note of the losses that it tells.
  Stamp read(msghdr& header);

  /// Says in words that the receive buffer of `whose` is smaller than was asked for; empty when it is not.
  std::string buffer_remark(const std::string& whose) const;

  /// Messages that the kernel has dropped, for the receive buffer was full.
  std::uint64_t lost() const { return lost_.value(); }

 private:
  void read_losses(int fd);
  void note_losses(std::uint32_t kernel_count);

  HostClock clock_;
  int wanted_bytes_ = 0;
  int granted_bytes_ = 0;
  Stamp last_received_{};
  ClockReadings readings_;          // of the batch in hand
  std::uint32_t kernel_count_ = 0;  // losses as the kernel last told them; wraps
  Counter lost_;                    // written by the receiving thread
};

}  // namespace slamd::transport
