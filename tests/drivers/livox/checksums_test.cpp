#include "drivers/livox/checksums.hpp"

#include <gtest/gtest.h>

#include <string_view>

#include "tests/hex/hex.hpp"

namespace slamd::livox {
namespace {

using hex::Bytes;
using hex::from_hex;

constexpr std::string_view kCheck = "123456789";

std::span<const std::byte> check_bytes() { return std::as_bytes(std::span(kCheck)); }

TEST(LivoxChecksums, HaveTheCheckValuesOfTheirDefinitions) {
  EXPECT_EQ(sdk1_crc32(check_bytes()), 0xB08DB5B1U);
  EXPECT_EQ(sdk1_crc16(check_bytes()), 0xAB4E);
  EXPECT_EQ(sdk2_crc16(check_bytes()), 0x29B1);
}

TEST(LivoxChecksums, MatchTheHeartbeatOfSdk1) {
  const Bytes heartbeat = from_hex("AA010F0000000004D7000338BA8D0C");
  const std::span<const std::byte> bytes(heartbeat);

  EXPECT_EQ(sdk1_crc16(bytes.first(7)), 0xD704);
  EXPECT_EQ(sdk1_crc16(bytes.first(9)), 0);  // the residue
  EXPECT_EQ(sdk1_crc32(bytes.first(11)), 0x0C8DBA38U);
}

}  // namespace
}  // namespace slamd::livox
