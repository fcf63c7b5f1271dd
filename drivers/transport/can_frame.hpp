#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/stamp.hpp"

namespace slamd::transport {

/// A data frame of CAN 2.0.
struct CanFrame {
  std::uint32_t id = 0;
  bool is_extended = false;  // 29 bits of id rather than 11
  std::uint8_t size = 0;     // of data, at most 8
  std::array<std::byte, 8> data{};
  Stamp received{};

  std::span<const std::byte> bytes() const { return std::span(data).first(size); }
};

/// Frames that are wanted: those whose id agrees with `id` in the bits of `mask`.
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x1FFF'FFFF;
  bool is_extended = false;

  bool operator==(const CanFilter&) const = default;
};

}  // namespace slamd::transport
