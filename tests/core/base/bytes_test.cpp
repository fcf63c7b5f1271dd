#include "core/base/bytes.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <limits>

namespace slamd {
namespace {

constexpr std::array<std::byte, 9> kBytes{std::byte{0xFF},
                                          std::byte{0x01},
                                          std::byte{0x02},
                                          std::byte{0x03},
                                          std::byte{0x84},
                                          std::byte{0x05},
                                          std::byte{0x06},
                                          std::byte{0x07},
                                          std::byte{0x88}};

TEST(Bytes, LoadsLittleEndianAtAnyOffset) {
  EXPECT_EQ(load_le<std::uint8_t>(kBytes, 0), 0xFFU);
  EXPECT_EQ(load_le<std::uint16_t>(kBytes, 1), 0x0201U);
  EXPECT_EQ(load_le<std::uint32_t>(kBytes, 1), 0x84030201U);
  EXPECT_EQ(load_le<std::int32_t>(kBytes, 1), static_cast<std::int32_t>(0x84030201U));
  EXPECT_EQ(load_le<std::uint64_t>(kBytes, 1), 0x8807060584030201U);
}

TEST(Bytes, LoadsBigEndianAtAnyOffset) {
  EXPECT_EQ(load_be<std::uint16_t>(kBytes, 1), 0x0102U);
  EXPECT_EQ(load_be<std::uint32_t>(kBytes, 1), 0x01020384U);
  EXPECT_EQ(load_be<std::uint64_t>(kBytes, 1), 0x0102038405060788U);
}

TEST(Bytes, LoadsFloats) {
  const std::array<std::byte, 4> one_le{
      std::byte{0}, std::byte{0}, std::byte{0x80}, std::byte{0x3F}};

  EXPECT_EQ(load_le<float>(one_le, 0), 1.0F);
}

TEST(Bytes, ReadingPastTheEndIsAProgrammerError) {
  EXPECT_DEATH(load_le<std::uint32_t>(kBytes, 6), "assertion failed");
  EXPECT_DEATH(load_be<std::uint64_t>(kBytes, 2), "assertion failed");
}

template <typename T>
void check_round_trip() {
  const auto value = *rc::gen::arbitrary<T>();
  std::array<std::byte, 12> bytes{};

  store_le(std::span<std::byte>(bytes), 3, value);
  RC_ASSERT(load_le<T>(bytes, 3) == value);

  store_be(std::span<std::byte>(bytes), 3, value);
  RC_ASSERT(load_be<T>(bytes, 3) == value);
  RC_ASSERT(bytes[0] == std::byte{0} && bytes[3 + sizeof(T)] == std::byte{0});
}

RC_GTEST_PROP(Bytes, StoresWhatItLoads16, ()) {
  check_round_trip<std::uint16_t>();
}

RC_GTEST_PROP(Bytes, StoresWhatItLoads32, ()) {
  check_round_trip<std::int32_t>();
}

RC_GTEST_PROP(Bytes, StoresWhatItLoads64, ()) {
  check_round_trip<std::uint64_t>();
}

RC_GTEST_PROP(Bytes, StoresWhatItLoadsDouble, ()) {
  check_round_trip<double>();
}

}  // namespace
}  // namespace slamd
