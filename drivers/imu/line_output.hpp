#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/fixed_vector.hpp"

namespace slamd::imu {

/// What has been found out about a sensor on a serial line.
struct LineEvent {
  enum class Kind : std::uint8_t {
    kFound,       // value: the rate in baud at which it is heard
    kConfigured,  // value: the samples a second that it sends from now on
    kRefused,     // value: its error code; it goes on as it was
    kTakenAsItIs, // it sends, but does not answer
    kMute,        // it neither sends nor answers
  };

  Kind kind = Kind::kMute;
  std::uint32_t value = 0;
};

/// What a conversation with a sensor wants done: bytes to be sent and events to be told.
struct LineOutput {
  FixedVector<std::byte, 512> bytes;
  FixedVector<LineEvent, 4> events;

  /// Appends bytes to be sent; all of them, or, when there is no room, none: commands are repeated anyway.
  void send(std::span<const std::byte> more) {
    if (more.size() > bytes.capacity() - bytes.size()) {
      return;
    }
    for (const std::byte byte : more) {
      bytes.push_back(byte);
    }
  }

  void tell(LineEvent::Kind kind, std::uint32_t value = 0) { events.try_push_back({kind, value}); }
};

}  // namespace slamd::imu
