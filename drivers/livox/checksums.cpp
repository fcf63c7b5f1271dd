#include "drivers/livox/checksums.hpp"

#include "core/base/crc32.hpp"

namespace slamd::livox {

namespace {

constexpr std::uint32_t kSdk1Seed32 = 0x564F580A;  // what the vendor calls "crc32 seed"
constexpr std::uint16_t kSdk1Seed16 = 0x4C49;

}  // namespace

std::uint32_t sdk1_crc32(std::span<const std::byte> bytes) { return crc32(bytes, kSdk1Seed32); }

std::uint16_t sdk1_crc16(std::span<const std::byte> bytes) {
  std::uint32_t crc = kSdk1Seed16;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? crc >> 1 ^ 0x8408U : crc >> 1;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

std::uint16_t sdk2_crc16(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xFFFF;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte) << 8;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? (crc << 1 ^ 0x1021U) & 0xFFFFU : crc << 1;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace slamd::livox
