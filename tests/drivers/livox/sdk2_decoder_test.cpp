#include "drivers/livox/sdk2_decoder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/bytes.hpp"
#include "tests/hex/hex.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::livox {
namespace {

using hex::Bytes;
using hex::from_hex;
using hex::to_hex;

constexpr Stamp kReceived{std::chrono::seconds{1'795'327'325}};
constexpr double kStandardGravity_mps2 = 9.80665;

// The golden vectors of livox-sdk2.md.
constexpr std::string_view kImuPacket =
    "003C00000001000700000001000000000000000000000000334BFFC21565EE71B048EA18"
    "0AD7233C0AD7A3BC8FC2F53C00000000000000000000803F";
constexpr std::string_view kPointPacket =
    "004000320002000800000100000000000000000000000000ADB4E142141A99BE1C000000"
    "E803000030F8FFFF2C0100004D000000000000000000000000000000";
constexpr std::string_view kDiscovery = "AA0018000100000000000000000000000000A91F00000000";

struct TypeSize {
  std::uint8_t data_type;
  std::size_t firing_bytes;
};

constexpr TypeSize kPointTypes[] = {{0x01, 14}, {0x02, 8}, {0x03, 10}, {0x11, 28}};

Sdk2Header header_of(std::uint8_t data_type, std::uint16_t firings) {
  Sdk2Header header;
  header.data_type = data_type;
  header.points = firings;
  header.time_interval_100ns = 4750;
  header.time_type = 1;
  header.timestamp_ns = 1'795'327'324'123'456'789;
  return header;
}

// A packet of the given type whose firings are all empty, but for what hex says of the first ones.
Bytes packet_of(const Sdk2Header& header, std::string_view hex = "") {
  const auto* type =
      std::find_if(std::begin(kPointTypes), std::end(kPointTypes), [&](const TypeSize& t) {
        return t.data_type == header.data_type;
      });
  const std::size_t body = header.data_type == 0 ? kImuBytes : header.points * type->firing_bytes;
  Bytes packet(Sdk2Header::kBytes + body);
  const Bytes begin = from_hex(hex);
  std::copy(begin.begin(), begin.end(), packet.begin() + Sdk2Header::kBytes);
  seal_sdk2_packet(header, packet);
  return packet;
}

class Sdk2DecoderTest : public testing::Test {
 protected:
  DecodeResult decode(const Bytes& packet) { return sut_.decode(packet, kReceived, block_, imu_); }

  Sdk2Decoder sut_{Sdk2Config{}};
  sensor::PointBlock block_;
  ImuReading imu_;
};

void expect_near(const sensor::Point& point, double x_m, double y_m, double z_m) {
  EXPECT_NEAR(point.x_m, x_m, 1e-5);
  EXPECT_NEAR(point.y_m, y_m, 1e-5);
  EXPECT_NEAR(point.z_m, z_m, 1e-5);
}

TEST_F(Sdk2DecoderTest, ReadsTheGoldenImuPacketInSiUnits) {
  ASSERT_EQ(decode(from_hex(kImuPacket)), DecodeResult::kImu);

  EXPECT_EQ(imu_.device_stamp.time_since_epoch().count(), 1'795'327'324'123'456'789);
  EXPECT_EQ(imu_.received, kReceived);
  EXPECT_TRUE(imu_.angular_rate_radps.isApprox(Eigen::Vector3d(0.01, -0.02, 0.03), 1e-6));
  EXPECT_TRUE(imu_.specific_force_mps2.isApprox(Eigen::Vector3d(0.0, 0.0, kStandardGravity_mps2), 1e-9));
  EXPECT_EQ(sut_.last_header().number, 7);
  EXPECT_EQ(sut_.last_header().checksum, 0xC2FF4B33U);
  EXPECT_EQ(sdk2_time_type_of(sut_.last_header().time_type), Sdk2TimeType::kPtp);
}

TEST_F(Sdk2DecoderTest, ReadsTheGoldenPointPacket) {
  ASSERT_EQ(decode(from_hex(kPointPacket)), DecodeResult::kPoints);

  EXPECT_EQ(block_.device_stamp.time_since_epoch().count(), 123'456'789'012);
  EXPECT_EQ(block_.received, kReceived);
  EXPECT_EQ(block_.duration.count(), 10'000);  // two points 5 µs apart
  EXPECT_EQ(block_.empty_firings, 1U);
  ASSERT_EQ(block_.points.size(), 1U);
  expect_near(block_.points[0], 1.0, -2.0, 0.3);
  EXPECT_EQ(block_.points[0].intensity, 77);
  EXPECT_EQ(sut_.last_header().number, 8);
  EXPECT_EQ(sut_.last_header().checksum, 0x42E1B4ADU);
}

TEST_F(Sdk2DecoderTest, GivesTheGoldenPacketsBackWhenEncodedAgain) {
  ASSERT_EQ(decode(from_hex(kImuPacket)), DecodeResult::kImu);
  Bytes imu(Sdk2Header::kBytes + kImuBytes);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    store_le(imu, 36 + 4 * axis, static_cast<float>(imu_.angular_rate_radps[i]));
    store_le(imu, 48 + 4 * axis, static_cast<float>(imu_.specific_force_mps2[i] / kStandardGravity_mps2));
  }
  seal_sdk2_packet(sut_.last_header(), imu);
  EXPECT_EQ(to_hex(imu), kImuPacket);

  ASSERT_EQ(decode(from_hex(kPointPacket)), DecodeResult::kPoints);
  Bytes points(Sdk2Header::kBytes + 2 * 14);
  const sensor::Point& point = block_.points[0];
  store_le(points, 36, static_cast<std::int32_t>(std::lround(1e3F * point.x_m)));
  store_le(points, 40, static_cast<std::int32_t>(std::lround(1e3F * point.y_m)));
  store_le(points, 44, static_cast<std::int32_t>(std::lround(1e3F * point.z_m)));
  store_le(points, 48, point.intensity);
  seal_sdk2_packet(sut_.last_header(), points);
  EXPECT_EQ(to_hex(points), kPointPacket);
}

TEST_F(Sdk2DecoderTest, SpreadsTheIntervalFromTheFirstPointToTheLast) {
  std::string hex;
  for (int i = 0; i < 96; ++i) {
    hex += "E803000000000000000000000100";
  }

  ASSERT_EQ(decode(packet_of(header_of(1, 96), hex)), DecodeResult::kPoints);

  ASSERT_EQ(block_.points.size(), 96U);
  for (std::size_t i = 0; i < 96; ++i) {
    EXPECT_EQ(block_.points[i].offset_ns, 5000 * i);
    EXPECT_EQ(block_.points[i].line, i % 4);
  }
  EXPECT_EQ(block_.duration.count(), 480'000);
}

TEST_F(Sdk2DecoderTest, SpreadsTheIntervalAsTheVendorsDriverDoesWhenTold) {
  Sdk2Config config;
  config.interval = Sdk2Interval::kFirstToNextPacket;
  Sdk2Decoder sut(config);
  Sdk2Header header = header_of(1, 96);
  header.time_interval_100ns = 4800;

  ASSERT_EQ(sut.decode(packet_of(header, std::string(28, '0') + "E803000000000000000000000100"), kReceived, block_, imu_),
            DecodeResult::kPoints);

  EXPECT_EQ(block_.points[0].offset_ns, 5000U);
  EXPECT_EQ(block_.duration.count(), 480'000);
}

TEST_F(Sdk2DecoderTest, TakesTheNominalRateWhereAPacketTellsNoInterval) {
  Sdk2Header header = header_of(1, 96);
  header.time_interval_100ns = 0;
  ASSERT_EQ(decode(packet_of(header)), DecodeResult::kPoints);
  EXPECT_EQ(block_.duration.count(), 480'000);

  ASSERT_EQ(decode(packet_of(header_of(1, 1))), DecodeResult::kPoints);
  EXPECT_EQ(block_.duration.count(), 5'000);
}

TEST_F(Sdk2DecoderTest, ReadsPointsOfSixteenBits) {
  ASSERT_EQ(decode(packet_of(header_of(2, 96), "6400" "38FF" "1E00" "4D00")), DecodeResult::kPoints);

  ASSERT_EQ(block_.points.size(), 1U);
  expect_near(block_.points[0], 1.0, -2.0, 0.3);
  EXPECT_EQ(block_.points[0].intensity, 77);
  EXPECT_EQ(block_.empty_firings, 95U);
}

TEST_F(Sdk2DecoderTest, ReadsSphericalPoints) {
  ASSERT_EQ(decode(packet_of(header_of(3, 96), "39300000" "2823" "3C8C" "4D00")), DecodeResult::kPoints);

  ASSERT_EQ(block_.points.size(), 1U);
  expect_near(block_.points[0], 12.343120, -0.215450, 0.0);
}

TEST_F(Sdk2DecoderTest, ReadsBothEchoesOfAFiringAtOneTime) {
  const std::string firing = "E8030000000000000000000001" "00" "D0070000000000000000000002" "00";

  ASSERT_EQ(decode(packet_of(header_of(0x11, 48), std::string(56, '0') + firing)), DecodeResult::kPoints);

  ASSERT_EQ(block_.points.size(), 2U);
  expect_near(block_.points[1], 2.0, 0.0, 0.0);
  EXPECT_EQ(block_.points[0].line, 1);
  EXPECT_EQ(block_.points[1].line, 1);
  EXPECT_EQ(block_.points[1].echo, 1);
  EXPECT_EQ(block_.points[0].tag, 0x10);
  EXPECT_EQ(block_.points[1].tag, 0x20);
  EXPECT_EQ(block_.points[0].offset_ns, block_.points[1].offset_ns);
  EXPECT_EQ(block_.empty_firings, 47U);
}

TEST_F(Sdk2DecoderTest, CountsReturnsItCannotGiveOut) {
  Sdk2Config config;
  config.min_range_m = 0.5;
  config.max_range_m = 70.0;
  Sdk2Decoder sut(config);
  const Bytes gated = packet_of(header_of(1, 4),
                                "F3010000000000000000000001" "00"    // 0.499 m
                                "71110100000000000000000001" "00"    // 70.001 m
                                "70110100000000000000000001" "00");  // 70 m
  const Bytes askew = packet_of(header_of(3, 3), "39300000" "5146" "0000" "4D00"   // 180.01° from +z
                                                 "39300000" "0000" "A18C" "4D00");  // 360.01°

  ASSERT_EQ(sut.decode(gated, kReceived, block_, imu_), DecodeResult::kPoints);
  EXPECT_EQ(block_.points.size(), 1U);
  EXPECT_EQ(block_.empty_firings, 1U);
  EXPECT_EQ(sut.counters().decoded.out_of_range, 2U);

  ASSERT_EQ(sut.decode(askew, kReceived, block_, imu_), DecodeResult::kPoints);
  EXPECT_TRUE(block_.points.empty());
  EXPECT_EQ(sut.counters().decoded.bad_angles, 2U);
}

// Source: livox-sdk2.md §4: a cause's two bits are 0 for high, 1 for medium, 2 for low confidence.
TEST(Sdk2Tag, SaysLittleConfidenceAsNoiseAndSomeAsTheKindThatIsKept) {
  EXPECT_EQ(tag_from_sdk2(0x00), 0x00);
  EXPECT_EQ(tag_from_sdk2(0x02), 0x01);  // between objects
  EXPECT_EQ(tag_from_sdk2(0x01), 0x03);
  EXPECT_EQ(tag_from_sdk2(0x08), 0x04);  // rain, fog, dust
  EXPECT_EQ(tag_from_sdk2(0x04), 0x08);
  EXPECT_EQ(tag_from_sdk2(0x20), 0x04);  // anything else
  EXPECT_EQ(tag_from_sdk2(0x18), 0x04);  // the worse of two
  EXPECT_EQ(tag_from_sdk2(0xFF), 0x00);  // reserved values say nothing
}

TEST_F(Sdk2DecoderTest, RefusesAnyChangeOfWhatTheChecksumCovers) {
  for (const std::string_view golden : {kImuPacket, kPointPacket}) {
    const Bytes good = from_hex(golden);
    for (std::size_t bit = 8 * 24; bit < 8 * good.size(); ++bit) {
      Bytes packet = good;
      packet[bit / 8] ^= std::byte{1} << bit % 8;

      ASSERT_EQ(decode(packet), DecodeResult::kBadChecksum) << bit;
    }
  }
  EXPECT_EQ(block_.received, Stamp{});
  EXPECT_EQ(imu_.received, Stamp{});
}

TEST_F(Sdk2DecoderTest, TakesAPacketThatCarriesNoChecksumAndCountsIt) {
  Bytes packet = from_hex(kImuPacket);
  store_le<std::uint32_t>(packet, 24, 0);

  EXPECT_EQ(decode(packet), DecodeResult::kImu);
  EXPECT_EQ(sut_.counters().without_checksum, 1U);
}

TEST_F(Sdk2DecoderTest, RefusesAnImuSampleThatIsNotFinite) {
  for (std::size_t field = 0; field < 6; ++field) {
    Bytes packet = from_hex(kImuPacket);
    store_le<float>(packet, 36 + 4 * field, std::numeric_limits<float>::infinity());
    seal_sdk2_packet(header_of(0, 1), packet);

    EXPECT_EQ(decode(packet), DecodeResult::kBadImu);
  }
  EXPECT_EQ(imu_.received, Stamp{});
}

TEST_F(Sdk2DecoderTest, AcceptsEachDefinedTimeTypeAndNoOther) {
  for (int type = 0; type < 256; ++type) {
    Sdk2Header header = header_of(1, 96);
    header.time_type = static_cast<std::uint8_t>(type);

    EXPECT_EQ(decode(packet_of(header)), type <= 2 ? DecodeResult::kPoints : DecodeResult::kBadTimestampType);
  }
}

TEST_F(Sdk2DecoderTest, RefusesTimesBeyondTheClock) {
  Sdk2Header header = header_of(1, 96);
  header.timestamp_ns = 1ULL << 63;

  EXPECT_EQ(decode(packet_of(header)), DecodeResult::kBadTimestamp);
}

TEST_F(Sdk2DecoderTest, NamesEachRefusalByItsReason) {
  Bytes sdk1 = packet_of(header_of(1, 96));
  sdk1[0] = std::byte{5};
  Bytes longer = packet_of(header_of(1, 96));
  longer.push_back({});
  Bytes fewer = packet_of(header_of(1, 96));
  seal_sdk2_packet(header_of(1, 95), fewer);
  Bytes none(36);
  seal_sdk2_packet(header_of(1, 0), none);
  Bytes type = packet_of(header_of(1, 96));
  seal_sdk2_packet(header_of(4, 96), type);

  EXPECT_EQ(decode({}), DecodeResult::kTooShort);
  EXPECT_EQ(decode(from_hex(kDiscovery)), DecodeResult::kControlFrame);
  EXPECT_EQ(decode(sdk1), DecodeResult::kUnknownVersion);
  EXPECT_EQ(decode(longer), DecodeResult::kWrongLength);
  EXPECT_EQ(decode(fewer), DecodeResult::kWrongLength);
  EXPECT_EQ(decode(none), DecodeResult::kWrongLength);
  EXPECT_EQ(decode(type), DecodeResult::kUnknownDataType);
  EXPECT_EQ(sut_.counters().decoded.of(DecodeResult::kWrongLength), 3U);
  EXPECT_EQ(name_of(DecodeResult::kBadChecksum), "bad_checksum");
}

TEST_F(Sdk2DecoderTest, RefusesMorePointsThanABlockHolds) {
  constexpr auto kMost = static_cast<std::uint16_t>(sensor::PointBlock::kMaxPoints);

  EXPECT_EQ(decode(packet_of(header_of(2, kMost))), DecodeResult::kPoints);
  EXPECT_EQ(decode(packet_of(header_of(2, kMost + 1))), DecodeResult::kWrongLength);
  EXPECT_EQ(decode(packet_of(header_of(0x11, kMost / 2 + 1))), DecodeResult::kWrongLength);
}

TEST_F(Sdk2DecoderTest, RefusesEveryTruncationOfEveryType) {
  std::vector<Bytes> packets = {from_hex(kImuPacket), from_hex(kPointPacket)};
  for (const TypeSize& type : kPointTypes) {
    packets.push_back(packet_of(header_of(type.data_type, 48)));
  }
  for (const Bytes& whole : packets) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));

      ASSERT_EQ(decode(cut), size < 36 ? DecodeResult::kTooShort : DecodeResult::kWrongLength);
    }
  }
  EXPECT_EQ(block_.received, Stamp{});
}

TEST_F(Sdk2DecoderTest, CountsMissingPacketsOfEachStreamByTheirNumbers) {
  const auto send = [&](std::uint8_t data_type, std::uint16_t number) {
    Sdk2Header header = header_of(data_type, data_type == 0 ? 1 : 96);
    header.number = number;
    decode(packet_of(header));
  };
  for (const std::uint16_t number : {65'534, 65'535, 0, 3}) {  // 1 and 2 are missing
    send(1, number);
    send(0, static_cast<std::uint16_t>(number / 2));
  }
  send(1, 3);  // again
  send(1, 0);  // restarted
  send(1, 1);

  EXPECT_EQ(sut_.counters().points_packets_missing, 2U);
  EXPECT_EQ(sut_.counters().imu_packets_missing, 0U);  // 32767, 32767, 0, 1
}

TEST_F(Sdk2DecoderTest, SurvivesAnyBytesAndCountsEachDatagramOnce) {
  std::mt19937 random(11);
  std::uint64_t datagrams = 0;
  for (int round = 0; round < 5'000; ++round) {
    Bytes packet = round % 3 == 0 ? Bytes(random() % 1500) : packet_of(header_of(kPointTypes[random() % 4].data_type, 48));
    for (std::size_t i = random() % 8; i > 0 && !packet.empty(); --i) {
      packet[random() % packet.size()] = static_cast<std::byte>(random());
    }
    if (round % 2 == 0 && packet.size() >= 36) {  // past the checksum
      store_le(packet, 24, sdk2_checksum(packet));
    }

    const DecodeResult result = decode(packet);

    ++datagrams;
    if (result == DecodeResult::kPoints) {
      for (const sensor::Point& point : block_.points) {
        ASSERT_TRUE(point.line < 4 && point.echo < 2);
        ASSERT_LT(Duration{point.offset_ns}, block_.duration);
      }
    }
  }
  std::uint64_t counted = 0;
  for (const std::uint64_t count : sut_.counters().decoded.packets) {
    counted += count;
  }
  EXPECT_EQ(counted, datagrams);
}

TEST_F(Sdk2DecoderTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::vector<Bytes> packets = {from_hex(kImuPacket), from_hex(kPointPacket), from_hex(kDiscovery), Bytes(3)};
  for (const TypeSize& type : kPointTypes) {
    packets.push_back(packet_of(header_of(type.data_type, 48)));
    std::fill(packets.back().begin() + 36, packets.back().end(), std::byte{1});
    store_le<std::uint32_t>(packets.back(), 24, 0);
  }

  const std::size_t allocations = support::count_allocations([&] {
    for (const Bytes& packet : packets) {
      decode(packet);
    }
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::livox
