#pragma once

#include <string_view>

#include "drivers/transport/can_frame.hpp"
#include "tests/hex/hex.hpp"

namespace slamd::can {

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};

inline CanFrame frame_of(std::uint32_t id, std::string_view hex, Stamp received = kBegin) {
  const hex::Bytes bytes = hex::from_hex(hex);
  CanFrame frame;
  frame.id = id;
  frame.is_extended = id > 0x7FF;
  frame.size = static_cast<std::uint8_t>(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    frame.data[i] = bytes[i];
  }
  frame.received = received;
  return frame;
}

}  // namespace slamd::can
