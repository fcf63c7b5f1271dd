#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace slamd::livox {

/// The CRC-32 at the end of an SDK1 frame (check 0xB08DB5B1). Source: livox-sdk1.md §2.1.
std::uint32_t sdk1_crc32(std::span<const std::byte> bytes);

/// The CRC-16 of an SDK1 frame's header (check 0xAB4E). Source: livox-sdk1.md §2.1.
std::uint16_t sdk1_crc16(std::span<const std::byte> bytes);

/// The CRC-16 of an SDK2 command's header: CCITT-FALSE (check 0x29B1). Source: livox-sdk2.md §2.
std::uint16_t sdk2_crc16(std::span<const std::byte> bytes);

}  // namespace slamd::livox
