#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/livox/control_frame.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// Asks an Avia that looks for no host whether it has one, by the only question that it answers to anybody: a handshake
/// (livox-sdk1.md §3), which a device that has a host refuses. One that consents is let go at once, before it has done
/// anything for this host, and looks for a host again.
/// Without socket or clock.  Threads: one.
class AviaQuestion {
 public:
  static constexpr std::uint16_t kDevicePort = 65000;
  static constexpr int kTries = 3;

  explicit AviaQuestion(std::uint32_t address) : address_(address) {}

  /// The handshake of a host at this address, whose answer is heard at this port; empty when all is said. To be called
  /// once a second.
  livox::FrameBytes question(std::uint32_t host_address, std::uint16_t port);

  /// Takes what the device has sent. Returns what lets it go, where it has consented; else nothing. Any bytes may be given.
  livox::FrameBytes take(std::span<const std::byte> datagram);

  std::uint32_t address() const { return address_; }
  AviaAnswer answer() const { return answer_; }

 private:
  std::uint32_t address_;
  AviaAnswer answer_ = AviaAnswer::kNotAsked;
  std::uint16_t number_ = 0;
};

}  // namespace slamd::sensors
