#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/counter.hpp"
#include "drivers/transport/can_frame.hpp"
#include "drivers/transport/host_clock.hpp"
#include "drivers/transport/receipts.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::transport {

struct CanSocketConfig {
  std::string interface;           // "can0"
  std::vector<CanFilter> filters;  // empty: all frames
  int receive_buffer_bytes = 4 << 20;
};

/// What an interface is found to be.
enum class CanLink : std::uint8_t { kUnknown, kAbsent, kNotCan, kDown, kUp };

/// Says it in words, behind an interface's name.
const char* in_words(CanLink link);

/// What became of the frames that passed the filters, and what the controller has told of itself.
struct CanCounters {
  std::uint64_t received = 0;         // handed to the caller
  std::uint64_t other = 0;            // remote requests, and what is no frame of CAN 2.0
  std::uint64_t kernel_lost = 0;      // dropped in the kernel, for the receive buffer was full
  std::uint64_t controller_lost = 0;  // times that the controller's own buffer overflowed
  std::uint64_t bus_off = 0;          // times that it had to leave the bus
  std::uint64_t restarted = 0;        // times that it came back
  std::uint64_t warnings = 0;         // times that its errors passed the warning limit
  std::uint64_t passive = 0;          // times that it became error passive
};

/// Receives the frames of a CAN interface with the kernel's receive stamps, converted to slamd's time base, as Receipts
/// says. Only listens: it sends nothing.
///
/// The interface may be absent, go down, and come back as another one: attend() finds that, and binds to it anew.
/// Threads: one thread calls receive(), one attend(); the others are for any.
/// Real-time: allocates in the constructor only; receive() never blocks, but attend() may where the kernel does.
class CanSocket {
 public:
  static constexpr std::size_t kBatch = 32;

  /// Opens the socket; bound to the interface it is with attend().
  /// Errors: TransportError: the kernel has no CAN, no permission.
  CanSocket(const CanSocketConfig& config, const HostClock& clock);

  /// Takes over a socket that brings frames as the kernel's CAN does; for tests.
  CanSocket(int fd, std::string interface, const HostClock& clock);

  ~CanSocket();
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  /// Takes up to kBatch waiting frames from the kernel and calls visit(const CanFrame&) for each that carries data.
  /// Returns how many it took, others included: 0 when none was waiting.
  template <typename Visit>
  std::size_t receive(Visit&& visit) {
    const std::size_t taken = take_batch();
    CanFrame frame;
    for (std::size_t i = 0; i < taken; ++i) {
      if (open(i, frame)) {
        visit(std::as_const(frame));
      }
    }
    return taken;
  }

  /// Looks for the interface, and binds to it if it is another one than before.
  CanLink attend();

  /// What attend() found last.
  CanLink link() const { return link_.load(std::memory_order_relaxed); }

  const std::string& interface() const { return interface_; }

  /// The kernel's number of the interface; 0: none yet.
  int interface_index() const { return index_.load(std::memory_order_relaxed); }

  /// For epoll, level-triggered; stays the same whatever happens to the interface.
  int fd() const { return fd_; }

  /// Says in words that the receive buffer is smaller than configured; empty when it is not.
  std::string buffer_remark() const;

  CanCounters counters() const;

 private:
  struct Batch;

  void open_socket(int receive_buffer_bytes);
  bool set_filters() const;
  bool bind_to(int index);
  std::size_t take_batch();
  bool open(std::size_t index, CanFrame& frame);
  void note_error(std::uint32_t id, std::span<const std::byte> data);

  std::string interface_;
  std::vector<CanFilter> filters_;
  Receipts receipts_;
  int fd_ = -1;
  std::unique_ptr<Batch> batch_;  // scratch, sized once
  // Written by the thread that attends.
  std::atomic<CanLink> link_{CanLink::kUnknown};
  std::atomic<int> index_{0};
  // Written by the thread that receives.
  Counter received_;
  Counter other_;
  Counter controller_lost_;
  Counter bus_off_;
  Counter restarted_;
  Counter warnings_;
  Counter passive_;
};

}  // namespace slamd::transport
