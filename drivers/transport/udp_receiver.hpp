#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/base/counter.hpp"
#include "core/base/stamp.hpp"
#include "drivers/transport/host_clock.hpp"
#include "drivers/transport/receipts.hpp"
#include "drivers/transport/transport_error.hpp"

namespace slamd::transport {

struct UdpReceiverConfig {
  std::string bind_address = "0.0.0.0";
  std::uint16_t port = 0;      // 0: a free one, see UdpReceiver::port()
  std::string source_address;  // dotted; empty: anyone's until pin()
  int receive_buffer_bytes = 4 << 20;
};

/// One UDP datagram. The payload is valid until the visit returns.
struct Datagram {
  std::span<const std::byte> payload;
  Stamp received{};                  // by the kernel
  std::uint32_t source_address = 0;  // host order: 192.168.1.201 is 0xC0A801C9
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
};

/// What became of the datagrams that reached the port; the sum is what was sent to it.
struct UdpCounters {
  std::uint64_t received = 0;        // handed to the caller
  std::uint64_t foreign_source = 0;  // from another address than the sensor's
  std::uint64_t truncated = 0;       // longer than UdpReceiver::kMaxPayloadBytes
  std::uint64_t kernel_lost = 0;     // dropped in the kernel, for the receive buffer was full
};

/// Receives UDP datagrams of one port with the kernel's receive stamps, converted to slamd's time base.
///
/// Stamps are as Receipts says.
/// Threads: one thread calls receive(), pin() and unpin(); counters() is for any thread.
/// Real-time: allocates in the constructor only; never blocks.
class UdpReceiver {
 public:
  static constexpr std::size_t kBatch = 32;
  static constexpr std::size_t kMaxPayloadBytes = 2048;

  /// Binds the port. Errors: TransportError: the port is taken (by whom, where that can be seen), the address is none
  /// of this host's, no permission.
  UdpReceiver(const UdpReceiverConfig& config, const HostClock& clock);
  ~UdpReceiver();
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// Takes up to kBatch waiting datagrams from the kernel and calls visit(const Datagram&) for each one of the sensor's.
  /// Returns how many it took, dropped ones included: 0 when none was waiting.
  template <typename Visit>
  std::size_t receive(Visit&& visit) {
    const std::size_t taken = take_batch();
    Datagram datagram;
    for (std::size_t i = 0; i < taken; ++i) {
      if (open(i, datagram)) {
        visit(std::as_const(datagram));
      }
    }
    return taken;
  }

  /// Takes from now on only what this address (host order) sends: called with the first sender whose datagram made
  /// sense. Without effect where the configuration names the source.
  void pin(std::uint32_t source_address);

  /// Listens to anyone again, but for a source that the configuration names: when the sensor has long been silent.
  void unpin();

  /// The only sender that is listened to, if there is one.
  std::optional<std::uint32_t> pinned() const { return source_; }

  /// For epoll, level-triggered.
  int fd() const { return fd_; }

  /// The port that is bound.
  std::uint16_t port() const { return port_; }

  /// The receive buffer that the kernel has granted, in the unit of receive_buffer_bytes.
  int receive_buffer_bytes() const { return receipts_.granted_bytes(); }

  /// Says in words that the receive buffer is smaller than configured, and how to change that; empty when it is not.
  std::string buffer_remark() const;

  /// Returns what became of the datagrams; losses are complete when receive() has last found nothing waiting.
  UdpCounters counters() const;

 private:
  struct Batch;

  void open_socket(const UdpReceiverConfig& config);
  std::size_t take_batch();
  bool open(std::size_t index, Datagram& datagram);

  Receipts receipts_;
  int fd_ = -1;
  std::uint16_t port_ = 0;
  bool source_is_configured_ = false;
  std::optional<std::uint32_t> source_;
  std::unique_ptr<Batch> batch_;  // scratch, sized once
  Counter received_;              // written by the receiving thread, as are those below
  Counter foreign_source_;
  Counter truncated_;
};

/// Reads a dotted IPv4 address into host order; nothing when it is none.
std::optional<std::uint32_t> parse_address(const std::string& dotted);

/// Writes a host-order address with dots.
std::string dotted(std::uint32_t address);

}  // namespace slamd::transport
