#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd {

/// Returns the CRC-32 of Ethernet, zlib and Livox: polynomial 0x04C11DB7 reflected, xorout 0xFFFFFFFF (check 0xCBF43926).
/// `before`: that of the bytes in front of these, to go on with; or another seed, inverted.
/// Real-time: no allocation; O(bytes).
inline std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0) {
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
  std::uint32_t crc = ~before;
  for (const std::byte byte : bytes) {
    crc = (crc >> 8U) ^ kTable[(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~crc;
}

}  // namespace slamd
