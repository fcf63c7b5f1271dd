#pragma once

#include <cstddef>
#include <span>

#include "daemon/bus/messages.hpp"

namespace slamd::bus {

/// Encodes a message of lcm-gen's into a buffer. Returns its size, 0 where the buffer is too small.
template <typename Message>
std::size_t write_raw(const Message& message, std::span<std::byte> buffer) {
  const int size = message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
  return size < 0 ? 0 : static_cast<std::size_t>(size);
}

/// Decodes a message that fills the bytes exactly, and is no larger than one may be; returns whether it did. The counts by
/// which lcm-gen's decoders resize have been looked at before.
template <typename Message>
bool read_raw(std::span<const std::byte> bytes, Message& message) {
  return bytes.size() <= kLargestMessage_bytes &&
         message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) == static_cast<int>(bytes.size());
}

}  // namespace slamd::bus
