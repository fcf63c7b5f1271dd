#include "drivers/imu/imu_stream.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "stream_bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::imu {
namespace {

constexpr Stamp kReceived{std::chrono::seconds{1'700'000'000}};

/// A good sample of each protocol, and one of its damaged.
struct Example {
  Protocol protocol;
  Bytes good;
  Bytes damaged;
};

Bytes text_bytes(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  return {bytes.begin(), bytes.end()};
}

Bytes flipped(Bytes bytes, std::size_t at) {
  bytes[at] ^= std::byte{0x40};
  return bytes;
}

std::vector<Example> examples() {
  // The golden vectors of imu-serial.md.
  const Bytes xsens = from_hex(
      "FAFF3662102002A9861060040314ED5310100C07440BE007E301140D2F1837E020040180000740200CBC8E5466C0E82F10BF9AD29E40100CB93526"
      "9FBD949930BC46234680200CBB425C343B1068DF3AE1C7E58030103F800001B778C7F03738D82737107FEEF7");
  const Bytes mip =
      from_hex("756580300AD500000041D8BAE0400AD600000000007A12000E043C8EAF72BBDA6818BF7C52E80E05BB469CCF39A34C8BBB8BE12FD771");
  return {{Protocol::kCsv, text_bytes("\n1000,0.1,0.2,0.3,0,0,9.81\n"), text_bytes("1000,0.1,x,0.3,0,0,9.81\n")},
          {Protocol::kXsens, xsens, flipped(xsens, 40)},
          {Protocol::kMip, mip, flipped(mip, 30)}};
}

std::map<std::string, std::uint64_t> counts_of(const ImuStream& stream) {
  std::map<std::string, std::uint64_t> counts;
  stream.each_count([&](const char* name, std::uint64_t count) { counts[name] = count; });
  return counts;
}

TEST(ImuStream, ReadsEachProtocolAndCountsWhatItRefuses) {
  for (const Example& example : examples()) {
    ImuStream sut(example.protocol);
    std::vector<sensor::ImuReading> readings;
    const auto visit = [&](const sensor::ImuReading& reading) { readings.push_back(reading); };

    sut.add(example.good, kReceived, visit);
    sut.add(example.damaged, kReceived, visit);
    sut.add(example.good, kReceived, visit);

    EXPECT_EQ(sut.protocol(), example.protocol);
    ASSERT_EQ(readings.size(), 2U) << name_of(example.protocol);
    EXPECT_EQ(readings[0].received, kReceived);
    EXPECT_EQ(sut.summary().samples, 2U);
    EXPECT_EQ(sut.summary().refused, 1U) << name_of(example.protocol);
    EXPECT_EQ(counts_of(sut)["sample"], 2U);
  }
}

TEST(ImuStream, NamesTheReason) {
  ImuStream rows(Protocol::kCsv);
  ImuStream xsens(Protocol::kXsens);

  rows.add(examples()[0].damaged, kReceived, [](const sensor::ImuReading&) {});
  rows.add(examples()[0].damaged, kReceived, [](const sensor::ImuReading&) {});
  xsens.add(examples()[1].damaged, kReceived, [](const sensor::ImuReading&) {});

  EXPECT_EQ(counts_of(rows)["not_a_number"], 1U);
  EXPECT_EQ(counts_of(rows)["fragment"], 1U);
  EXPECT_EQ(counts_of(xsens)["damaged"], 1U);
  EXPECT_EQ(counts_of(xsens)["skipped_bytes"], examples()[1].damaged.size());
}

TEST(ImuStream, ForgetsWhatItHasInHandWhenTheStreamIsInterrupted) {
  for (const Example& example : examples()) {
    ImuStream sut(example.protocol);
    std::size_t samples = 0;
    const auto visit = [&](const sensor::ImuReading&) { ++samples; };
    const std::size_t half = example.good.size() / 2;

    sut.add(std::span(example.good).first(half), kReceived, visit);
    sut.finish(kReceived, visit);
    sut.add(std::span(example.good).subspan(half), kReceived, visit);
    sut.add(example.good, kReceived, visit);

    EXPECT_EQ(samples, 1U) << name_of(example.protocol);
  }
}

TEST(ImuStream, FindsTheSamplesBehindABeginningThatNeverEnds) {
  const std::vector<Example> all = examples();
  for (const auto& [example, announced] : {std::pair(all[1], from_hex("FAFF36FF0700")), std::pair(all[2], from_hex("756580FF"))}) {
    ImuStream sut(example.protocol);
    std::size_t samples = 0;
    const auto visit = [&](const sensor::ImuReading&) { ++samples; };
    sut.add(announced, kReceived, visit);
    sut.add(example.good, kReceived, visit);
    ASSERT_EQ(samples, 0U);

    sut.finish(kReceived, visit);

    EXPECT_EQ(samples, 1U);
  }
}

TEST(ImuStream, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  for (const Example& example : examples()) {
    ImuStream sut(example.protocol);
    std::size_t samples = 0;

    const std::size_t allocations = support::count_allocations([&] {
      sut.add(example.good, kReceived, [&](const sensor::ImuReading&) { ++samples; });
      sut.add(example.damaged, kReceived, [&](const sensor::ImuReading&) { ++samples; });
      sut.finish(kReceived, [&](const sensor::ImuReading&) { ++samples; });
      sut.summary();
    });

    EXPECT_EQ(samples, 1U);
    EXPECT_EQ(allocations, 0U);
  }
}

}  // namespace
}  // namespace slamd::imu
