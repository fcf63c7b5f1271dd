#include "daemon/bus/map_encoding.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/base/bytes.hpp"
#include "core/occupancy/mirror.hpp"
#include "daemon/bus/messages.hpp"

namespace slamd::bus {
namespace {

using occupancy::BlockStates;
using occupancy::MapDelta;
using occupancy::MapRequest;

/// The example of docs/protocol.md: a block that is all free, and one whose lowest layer is occupied and the rest free.
MapDelta example_of_the_page() {
  MapDelta delta;
  delta.stamp = Stamp(Duration(1'700'000'000'000'000'000));
  delta.map_id = 1'700'000'000'000'000'000;
  delta.epoch = 1;
  delta.covers = {100, 103};
  delta.newest = 103;
  delta.window = {{-10, -10, -3}, {20, 20, 6}};
  delta.submap = 2;
  delta.anchor = {5, 0, 0};
  BlockStates free;
  free.free.fill(~std::uint64_t{0});
  BlockStates floor = free;
  floor.free[0] = 0;
  floor.occupied[0] = ~std::uint64_t{0};
  delta.digest = free.digest({-10, -10, -3}) + floor.digest({0, 0, 0});
  occupancy::BlockWriter writer(delta);
  writer.add({101, {-10, -10, -3}, free});
  writer.add({103, {0, 0, 0}, floor});
  return delta;
}

template <typename Message>
std::vector<std::byte> bytes_of(const Message& message) {
  std::vector<std::byte> bytes(kLargestMessage_bytes);
  bytes.resize(encode(message, bytes));
  return bytes;
}

std::string hex_of(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += (text.empty() ? "" : " ");
    text += kDigits[std::to_integer<unsigned>(byte) >> 4U];
    text += kDigits[std::to_integer<unsigned>(byte) & 15U];
  }
  return text;
}

TEST(MapEncoding, IsWhatThePageSays) {
  const std::vector<std::byte> bytes = bytes_of(example_of_the_page());
  const auto at = [&](std::size_t from, std::size_t count) { return hex_of(std::span(bytes).subspan(from, count)); };

  ASSERT_EQ(bytes.size(), 117U);
  EXPECT_EQ(at(0, 8), "72 91 24 6d b7 eb e6 3b");
  EXPECT_EQ(at(8, 8), "17 97 9c fe 36 2a 00 00");
  EXPECT_EQ(at(16, 8), "17 97 9c fe 36 2a 00 00");
  EXPECT_EQ(at(24, 4), "00 00 00 01");
  EXPECT_EQ(at(28, 24), "00 00 00 00 00 00 00 64 00 00 00 00 00 00 00 67 00 00 00 00 00 00 00 67");
  EXPECT_EQ(at(52, 8), "95 9f 99 d7 06 e8 33 68");
  EXPECT_EQ(at(60, 4), "3e 4c cc cd");
  EXPECT_EQ(at(64, 12), "ff ff ff f6 ff ff ff f6 ff ff ff fd");
  EXPECT_EQ(at(76, 6), "00 14 00 14 00 06");
  EXPECT_EQ(at(82, 4), "00 00 00 02");
  EXPECT_EQ(at(86, 12), "00 00 00 05 00 00 00 00 00 00 00 00");
  EXPECT_EQ(at(98, 4), "00 02 00 0f");
  EXPECT_EQ(at(102, 15), "00 00 01 01 84 16 03 bf 7f 7f 7f 7f 7f 7f 7f");
}

TEST(MapEncoding, OfARequestIsWhatThePageSays) {
  MapRequest request;
  request.map_id = 1'700'000'000'000'000'000;
  request.ranges = {{0, 90}, {100, 101}};

  const std::vector<std::byte> bytes = bytes_of(request);

  EXPECT_EQ(hex_of(bytes),
            "c5 db 78 b3 f1 80 d3 7d 17 97 9c fe 36 2a 00 00 00 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 5a "
            "00 00 00 00 00 00 00 64 00 00 00 00 00 00 00 65");
}

TEST(MapEncoding, ReadsBackWhatItWrites) {
  const MapDelta sent = example_of_the_page();

  const auto delta = decode_map_delta(bytes_of(sent));

  ASSERT_TRUE(delta);
  EXPECT_EQ(delta->stamp, sent.stamp);
  EXPECT_EQ(delta->covers, sent.covers);
  EXPECT_EQ(delta->cell_m, 0.2);
  EXPECT_EQ(delta->window, sent.window);
  EXPECT_EQ(delta->submap, 2);
  EXPECT_EQ(delta->anchor, sent.anchor);
  occupancy::Mirror mirror;
  EXPECT_EQ(mirror.apply(*delta), occupancy::Mirror::Verdict::kNewMap);
  EXPECT_EQ(mirror.digest(), sent.digest);
  EXPECT_EQ(mirror.request().ranges[0], (occupancy::NumberRange{0, 100}));
  const auto request = decode_map_request(bytes_of(mirror.request()));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->ranges.size(), 1U);
}

TEST(MapEncoding, FitsAMessageWhenFull) {
  MapDelta delta = example_of_the_page();
  delta.payload.resize(MapDelta::kPayload_bytes);

  EXPECT_EQ(bytes_of(delta).size(), 102 + MapDelta::kPayload_bytes);
}

TEST(MapEncoding, RefusesWhatIsNoWholeMessage) {
  const std::vector<std::byte> good = bytes_of(example_of_the_page());
  MapRequest request;
  request.ranges = {{0, 1}};
  const std::vector<std::byte> good_request = bytes_of(request);
  ASSERT_TRUE(decode_map_request(good_request));

  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(decode_map_delta(std::span(good).first(size)));
  }
  for (std::size_t size = 0; size < good_request.size(); ++size) {
    EXPECT_FALSE(decode_map_request(std::span(good_request).first(size)));
  }
  for (const std::int16_t count : {-1, 0, 17, 32767}) {
    std::vector<std::byte> bytes = good_request;
    store_be(std::span(bytes), 16, count);
    EXPECT_FALSE(decode_map_request(bytes)) << count;
    bytes = good;
    store_be(std::span(bytes), 100, count);
    EXPECT_FALSE(decode_map_delta(bytes)) << count;
  }
  std::vector<std::byte> backwards = good_request;
  store_be(std::span(backwards), 18, std::int64_t{5});
  EXPECT_FALSE(decode_map_request(backwards));
  EXPECT_FALSE(decode_map_delta(good_request));
}

}  // namespace
}  // namespace slamd::bus
