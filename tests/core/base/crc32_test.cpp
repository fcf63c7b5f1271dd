#include "core/base/crc32.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace slamd {
namespace {

constexpr std::string_view kCheck = "123456789";  // of every catalogue of CRCs

TEST(Crc32, IsTheOneOfEthernet) { EXPECT_EQ(crc32(std::as_bytes(std::span(kCheck))), 0xCBF43926U); }

TEST(Crc32, GoesOnFromTheSumOfAnEarlierPart) {
  const auto bytes = std::as_bytes(std::span(kCheck));

  EXPECT_EQ(crc32(bytes.subspan(4), crc32(bytes.first(4))), crc32(bytes));
}

}  // namespace
}  // namespace slamd
