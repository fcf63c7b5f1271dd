#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd::bus {

/// Continues a CRC-32 (reflected 0x04C11DB7, as in Ethernet and zlib) over more bytes; begin with 0.
/// Real-time: no allocation; O(bytes).
inline std::uint32_t crc32(std::uint32_t crc, std::span<const std::byte> bytes) {
  static constexpr auto kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) {
        value = (value & 1U) != 0 ? (value >> 1U) ^ 0xEDB88320U : value >> 1U;
      }
      table[i] = value;
    }
    return table;
  }();
  crc = ~crc;
  for (const std::byte byte : bytes) {
    crc = (crc >> 8U) ^ kTable[(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~crc;
}

}  // namespace slamd::bus
