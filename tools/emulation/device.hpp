#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/stamp.hpp"
#include "drivers/livox/host_event.hpp"

namespace slamd::emulation {

/// What a device of either SDK answers to a command (livox-sdk1.md §3, livox-sdk2.md §3).
inline constexpr std::uint8_t kDone = 0;
inline constexpr std::uint8_t kFailed = 1;

/// What a device sends beside its answers.
enum class Stream : std::uint8_t { kPoints, kImu };

/// What a device wants done after it was given bytes or time: datagrams to be sent, and news for whoever watches it.
struct DeviceOutput {
  struct Datagram {
    std::uint16_t from_port = 0;  // of the device
    livox::Endpoint to;
    livox::FrameBytes bytes;
  };

  std::vector<Datagram> datagrams;
  std::vector<std::string> news;

  void clear() {
    datagrams.clear();
    news.clear();
  }
};

/// The device's side of a protocol, without thread, socket or clock.
class Device {
 public:
  virtual ~Device() = default;

  /// Takes a datagram that came to one of the device's ports. Any bytes may be given.
  virtual void receive(std::span<const std::byte> datagram, livox::Endpoint from, std::uint16_t to_port, Stamp now,
                       DeviceOutput& out) = 0;

  /// Lets time pass.
  virtual void advance(Stamp now, DeviceOutput& out) = 0;

  /// The ports of the device.
  virtual std::vector<std::uint16_t> ports() const = 0;

  /// Where a stream comes from, and goes now; nothing: it is not sent.
  virtual std::uint16_t source_port(Stream stream) const = 0;
  virtual std::optional<livox::Endpoint> destination(Stream stream) const = 0;
};

}  // namespace slamd::emulation
