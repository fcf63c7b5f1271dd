#include "drivers/livox/livox_decoder.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
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

constexpr Stamp kReceived{std::chrono::seconds{1'700'000'001}};

// The golden vectors of livox-sdk1.md.
constexpr std::string_view kHeaderPtpType2 = "0501010000600000010215CD853DFE9C9717";
constexpr std::string_view kHeaderGpsType2 = "050101000082000003021A0B160600176407";
constexpr std::string_view kPointType2 = "40F80000CD53FFFF69D6FFFF0610";
constexpr std::string_view kPointType3 = "3930000028233C8C4D10";
constexpr std::string_view kPointType5 = "28233C8C393000004D10A05B00000520";
constexpr std::string_view kPointType7 =
    "10270000C8000000D4FEFFFF3210983A00002C0100003EFEFFFF14200000000000000000000000000030";
constexpr std::string_view kPointType8 = "28233C8C393000004D10A05B00000520000000000030";
constexpr std::string_view kImuPacket =
    "0501010000600000010615CD853DFE9C97170AD7233C0AD7A3BC8FC2F53C00000000000000000000803F";
constexpr std::string_view kHeartbeat = "AA010F0000000004D7000338BA8D0C";

struct TypeSize {
  std::uint8_t data_type;
  std::size_t firings;
  std::size_t firing_bytes;
};

constexpr TypeSize kPointTypes[] = {{0, 100, 13},
                                    {1, 100, 9},
                                    {2, 96, 14},
                                    {3, 96, 10},
                                    {4, 48, 28},
                                    {5, 48, 16},
                                    {7, 30, 42},
                                    {8, 30, 22}};

// A packet of the given type whose firings are all empty.
Bytes empty_packet(const TypeSize& type) {
  Bytes packet = from_hex(kHeaderPtpType2);
  packet[9] = static_cast<std::byte>(type.data_type);
  packet.resize(DataHeader::kBytes + type.firings * type.firing_bytes);
  return packet;
}

Bytes packet_of(std::uint8_t data_type) {
  return empty_packet(*std::find_if(std::begin(kPointTypes),
                                    std::end(kPointTypes),
                                    [&](const TypeSize& t) { return t.data_type == data_type; }));
}

void put(Bytes& packet, std::size_t firing, std::string_view hex) {
  const Bytes point = from_hex(hex);
  std::copy(
      point.begin(),
      point.end(),
      packet.begin() + static_cast<std::ptrdiff_t>(DataHeader::kBytes + firing * point.size()));
}

class LivoxDecoderTest : public testing::Test {
 protected:
  DecodeResult decode(const Bytes& packet) { return sut_.decode(packet, kReceived, block_, imu_); }

  LivoxDecoder sut_{LivoxConfig{}};
  sensor::PointBlock block_;
  ImuReading imu_;
};

void expect_near(const sensor::Point& point, double x_m, double y_m, double z_m) {
  EXPECT_NEAR(point.x_m, x_m, 1e-5);
  EXPECT_NEAR(point.y_m, y_m, 1e-5);
  EXPECT_NEAR(point.z_m, z_m, 1e-5);
}

TEST_F(LivoxDecoderTest, ReadsTheRealPointAtItsOwnLineAndTime) {
  Bytes packet = packet_of(2);
  put(packet, 7, kPointType2);

  ASSERT_EQ(decode(packet), DecodeResult::kPoints);

  EXPECT_EQ(block_.device_stamp.time_since_epoch().count(), 1'700'000'000'123'456'789);
  EXPECT_EQ(block_.received, kReceived);
  EXPECT_EQ(block_.duration.count(), 400'000);
  EXPECT_EQ(block_.empty_firings, 95U);
  ASSERT_EQ(block_.points.size(), 1U);
  const sensor::Point& point = block_.points[0];
  expect_near(point, 63.552, -44.083, -10.647);
  EXPECT_EQ(point.intensity, 6);
  EXPECT_EQ(point.tag, 0x10);
  EXPECT_EQ(point.line, 1);
  EXPECT_EQ(point.echo, 0);
  EXPECT_EQ(point.offset_ns, 29'167U);  // 7 / 240 kHz
  EXPECT_EQ(sut_.last_status().time_sync, TimeSync::kPtp);
}

TEST_F(LivoxDecoderTest, DoesNotLetPointTimesDrift) {
  Bytes packet = packet_of(2);
  for (std::size_t i = 0; i < 96; ++i) {
    put(packet, i, kPointType2);
  }

  ASSERT_EQ(decode(packet), DecodeResult::kPoints);

  ASSERT_EQ(block_.points.size(), 96U);
  for (std::size_t i = 0; i < 96; ++i) {
    EXPECT_NEAR(block_.points[i].offset_ns, static_cast<double>(i) * 1e9 / 240'000.0, 0.5);
    EXPECT_EQ(block_.points[i].line, i % 6);
  }
  EXPECT_EQ(block_.points[95].offset_ns, 395'833U);  // i · 4167 ns would say 395,865
}

TEST_F(LivoxDecoderTest, ReadsSphericalPoint) {
  Bytes packet = packet_of(3);
  put(packet, 0, kPointType3);

  ASSERT_EQ(decode(packet), DecodeResult::kPoints);

  ASSERT_EQ(block_.points.size(), 1U);
  expect_near(block_.points[0], 12.343120, -0.215450, 0.0);
  EXPECT_EQ(block_.points[0].intensity, 77);
  EXPECT_EQ(block_.points[0].tag, 0x10);
}

TEST_F(LivoxDecoderTest, ReadsBothEchoesOfADualSphericalFiring) {
  Bytes packet = packet_of(5);
  put(packet, 8, kPointType5);

  ASSERT_EQ(decode(packet), DecodeResult::kPoints);

  EXPECT_EQ(block_.duration.count(), 200'000);
  EXPECT_EQ(block_.empty_firings, 47U);
  ASSERT_EQ(block_.points.size(), 2U);
  expect_near(block_.points[0], 12.343120, -0.215450, 0.0);
  EXPECT_EQ(block_.points[1].echo, 1);
  EXPECT_EQ(block_.points[1].intensity, 5);
  EXPECT_EQ(block_.points[1].tag, 0x20);
  EXPECT_NEAR(block_.points[1].x_m / block_.points[0].x_m, 23456.0 / 12345.0, 1e-6);
  EXPECT_EQ(block_.points[1].line, 2);  // of the firing, not of the return
  EXPECT_EQ(block_.points[0].offset_ns, block_.points[1].offset_ns);
}

TEST_F(LivoxDecoderTest, ReadsBothEchoesOfADualCartesianFiring) {
  Bytes packet = packet_of(4);
  put(packet, 0, std::string(kPointType2) + std::string(kPointType2));

  ASSERT_EQ(decode(packet), DecodeResult::kPoints);

  ASSERT_EQ(block_.points.size(), 2U);
  expect_near(block_.points[1], 63.552, -44.083, -10.647);
  EXPECT_EQ(block_.points[0].echo, 0);
  EXPECT_EQ(block_.points[1].echo, 1);
}

TEST_F(LivoxDecoderTest, LeavesOutTheAbsentEchoOfATripleFiring) {
  for (const auto& [data_type, hex] : {std::pair{7, kPointType7}, std::pair{8, kPointType8}}) {
    Bytes packet = packet_of(static_cast<std::uint8_t>(data_type));
    put(packet, 29, hex);

    ASSERT_EQ(decode(packet), DecodeResult::kPoints);

    EXPECT_EQ(block_.duration.count(), 125'000);
    EXPECT_EQ(block_.empty_firings, 29U);
    ASSERT_EQ(block_.points.size(), 2U);
    EXPECT_EQ(block_.points[0].line, 29 % 6);
    EXPECT_EQ(block_.points[1].echo, 1);
    EXPECT_EQ(block_.points[1].tag, 0x20);
  }
}

TEST_F(LivoxDecoderTest, KeepsTheEchoNumberWhenTheFirstReturnIsAbsent) {
  Bytes packet = packet_of(4);
  put(packet, 0, "0000000000000000000000000000" + std::string(kPointType2));

  ASSERT_EQ(decode(packet), DecodeResult::kPoints);

  ASSERT_EQ(block_.points.size(), 1U);
  EXPECT_EQ(block_.points[0].echo, 1);
}

TEST_F(LivoxDecoderTest, ReadsTheOldTypesWithoutTag) {
  LivoxDecoder sut(LivoxConfig{100'000, 1});
  Bytes cartesian = packet_of(0);
  put(cartesian, 99, kPointType2.substr(0, 26));
  Bytes spherical = packet_of(1);
  put(spherical, 99, kPointType3.substr(0, 18));

  ASSERT_EQ(sut.decode(cartesian, kReceived, block_, imu_), DecodeResult::kPoints);
  expect_near(block_.points[0], 63.552, -44.083, -10.647);
  EXPECT_EQ(block_.points[0].offset_ns, 990'000U);
  EXPECT_EQ(block_.points[0].line, 0);
  EXPECT_EQ(block_.points[0].tag, 0);
  ASSERT_EQ(sut.decode(spherical, kReceived, block_, imu_), DecodeResult::kPoints);
  expect_near(block_.points[0], 12.343120, -0.215450, 0.0);
  EXPECT_EQ(block_.points[0].intensity, 77);
}

TEST_F(LivoxDecoderTest, ReadsTheImuInSiUnits) {
  ASSERT_EQ(decode(from_hex(kImuPacket)), DecodeResult::kImu);

  EXPECT_EQ(imu_.device_stamp.time_since_epoch().count(), 1'700'000'000'123'456'789);
  EXPECT_EQ(imu_.received, kReceived);
  EXPECT_TRUE(imu_.angular_rate_radps.isApprox(Eigen::Vector3d(0.01, -0.02, 0.03), 1e-6));
  EXPECT_TRUE(imu_.specific_force_mps2.isApprox(Eigen::Vector3d(0.0, 0.0, 9.80665), 1e-9));
}

TEST_F(LivoxDecoderTest, RefusesAnImuSampleThatIsNotFinite) {
  for (std::size_t field = 0; field < 6; ++field) {
    Bytes packet = from_hex(kImuPacket);
    store_le<float>(packet, 18 + 4 * field, std::numeric_limits<float>::quiet_NaN());

    EXPECT_EQ(decode(packet), DecodeResult::kBadImu);
  }
  EXPECT_EQ(imu_.received, Stamp{});
}

TEST_F(LivoxDecoderTest, ReadsGpsCalendarTimeAsUtc) {
  Bytes packet = packet_of(2);
  const Bytes header = from_hex(kHeaderGpsType2);
  std::copy(header.begin(), header.end(), packet.begin());

  ASSERT_EQ(decode(packet), DecodeResult::kPoints);

  // 2026-11-22 06:02:04 UTC
  EXPECT_EQ(block_.device_stamp.time_since_epoch(), std::chrono::seconds{1'795'327'324});
  EXPECT_EQ(sut_.last_header().timestamp_type, 3);
}

TEST_F(LivoxDecoderTest, RefusesDatesThatAreNone) {
  struct Case {
    std::uint8_t month, day, hour;
    std::uint32_t us;
    DecodeResult expected;
  };

  // 2026 is no leap year; an hour may end in a leap second.
  for (const Case& c : {Case{2, 28, 23, 3'599'999'999U, DecodeResult::kPoints},
                        Case{2, 29, 0, 0, DecodeResult::kBadTimestamp},
                        Case{13, 1, 0, 0, DecodeResult::kBadTimestamp},
                        Case{0, 1, 0, 0, DecodeResult::kBadTimestamp},
                        Case{6, 0, 0, 0, DecodeResult::kBadTimestamp},
                        Case{6, 30, 24, 0, DecodeResult::kBadTimestamp},
                        Case{6, 30, 23, 3'600'999'999U, DecodeResult::kPoints},
                        Case{6, 30, 23, 3'601'000'000U, DecodeResult::kBadTimestamp}}) {
    Bytes packet = packet_of(2);
    const Bytes header = from_hex(kHeaderGpsType2);
    std::copy(header.begin(), header.end(), packet.begin());
    store_le(packet, 11, c.month);
    store_le(packet, 12, c.day);
    store_le(packet, 13, c.hour);
    store_le(packet, 14, c.us);

    EXPECT_EQ(decode(packet), c.expected) << int{c.month} << "-" << int{c.day} << " " << c.us;
  }
}

TEST_F(LivoxDecoderTest, AcceptsEachDefinedTimestampTypeAndNoOther) {
  for (int type = 0; type < 256; ++type) {
    Bytes packet = from_hex(kImuPacket);
    packet[8] = static_cast<std::byte>(type);
    store_le<std::uint64_t>(packet, 10, 999'999'999);

    const DecodeResult result = decode(packet);

    const bool counter = type == 0 || type == 1 || type == 4;
    if (type != 3) {  // these 8 bytes are no date
      EXPECT_EQ(result, counter ? DecodeResult::kImu : DecodeResult::kBadTimestampType) << type;
    }
  }
  EXPECT_EQ(imu_.device_stamp.time_since_epoch().count(), 999'999'999);
}

TEST_F(LivoxDecoderTest, RefusesStampsThatNoClockCanShow) {
  Bytes packet = from_hex(kImuPacket);
  store_le<std::uint64_t>(packet, 10, 1ULL << 63);
  EXPECT_EQ(decode(packet), DecodeResult::kBadTimestamp);

  packet[8] = std::byte{4};
  store_le<std::uint64_t>(packet, 10, 2'000'000'000);
  EXPECT_EQ(decode(packet), DecodeResult::kBadTimestamp);
}

TEST_F(LivoxDecoderTest, NamesControlFramesOnTheDataPort) {
  EXPECT_EQ(decode(from_hex(kHeartbeat)), DecodeResult::kControlFrame);
  EXPECT_EQ(decode(from_hex("AA011300020900D476000701000040607D6C0D")),
            DecodeResult::kControlFrame);
}

TEST_F(LivoxDecoderTest, NamesEachRefusalByItsReason) {
  Bytes version = packet_of(2);
  version[0] = std::byte{4};
  Bytes data_type = packet_of(2);
  data_type[9] = std::byte{9};
  Bytes longer = packet_of(2);
  longer.push_back({});

  EXPECT_EQ(decode({}), DecodeResult::kTooShort);
  EXPECT_EQ(decode(Bytes(17)), DecodeResult::kTooShort);
  EXPECT_EQ(decode(version), DecodeResult::kUnknownVersion);
  EXPECT_EQ(decode(data_type), DecodeResult::kUnknownDataType);
  EXPECT_EQ(decode(longer), DecodeResult::kWrongLength);
  EXPECT_EQ(sut_.counters().of(DecodeResult::kTooShort), 2U);
  EXPECT_EQ(sut_.counters().of(DecodeResult::kWrongLength), 1U);
  EXPECT_EQ(name_of(DecodeResult::kWrongLength), "wrong_length");
}

TEST_F(LivoxDecoderTest, RefusesEveryTruncationOfEveryTypeAndChangesNothing) {
  Bytes good = packet_of(2);
  put(good, 0, kPointType2);
  ASSERT_EQ(decode(good), DecodeResult::kPoints);

  for (const TypeSize& type : kPointTypes) {
    const Bytes whole = empty_packet(type);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      ASSERT_EQ(decode(cut), size < 18 ? DecodeResult::kTooShort : DecodeResult::kWrongLength);
    }
    ASSERT_EQ(block_.points.size(), 1U);
    ASSERT_EQ(block_.empty_firings, 95U);
  }
  const Bytes imu = from_hex(kImuPacket);
  for (std::size_t size = 18; size < imu.size(); ++size) {
    const Bytes cut(imu.begin(), imu.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(decode(cut), DecodeResult::kWrongLength);
  }
}

TEST_F(LivoxDecoderTest, GatesRangeAndCountsWhatItTakesOut) {
  LivoxConfig config;
  config.min_range_m = 20.0;
  config.max_range_m = 70.0;
  LivoxDecoder sut(config);
  Bytes packet = packet_of(7);
  put(packet, 0, kPointType7);  // 10 m, 15 m, none

  ASSERT_EQ(sut.decode(packet, kReceived, block_, imu_), DecodeResult::kPoints);
  EXPECT_TRUE(block_.points.empty());
  EXPECT_EQ(sut.counters().out_of_range, 2U);
  EXPECT_EQ(sut.counters().empty_firings, 29U);

  Bytes far = packet_of(2);
  put(far, 0, kPointType2);  // 78 m
  ASSERT_EQ(sut.decode(far, kReceived, block_, imu_), DecodeResult::kPoints);
  EXPECT_TRUE(block_.points.empty());
  EXPECT_EQ(sut.counters().out_of_range, 3U);
}

TEST_F(LivoxDecoderTest, CountsSphericalReturnsWithImpossibleAngles) {
  Bytes packet = packet_of(3);
  put(packet, 0, kPointType3);
  put(packet, 1, kPointType3);
  put(packet, 2, kPointType3);
  store_le<std::uint16_t>(packet, 18 + 4, 18'001);
  store_le<std::uint16_t>(packet, 18 + 10 + 6, 36'001);

  ASSERT_EQ(decode(packet), DecodeResult::kPoints);

  EXPECT_EQ(block_.points.size(), 1U);
  EXPECT_EQ(sut_.counters().bad_angles, 2U);
}

// Every return is a point, an empty one, or counted; every firing has a line, a time and an echo in
// its limits.
TEST_F(LivoxDecoderTest, AccountsForEveryReturnWhateverTheBytes) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (const TypeSize& type : kPointTypes) {
      LivoxDecoder sut{LivoxConfig{}};
      sensor::PointBlock block;
      ImuReading imu;
      Bytes packet = empty_packet(type);
      for (std::size_t i = DataHeader::kBytes; i < packet.size(); ++i) {
        packet[i] = random() % 4 == 0 ? static_cast<std::byte>(random()) : std::byte{0};
      }

      RC_ASSERT(sut.decode(packet, kReceived, block, imu) == DecodeResult::kPoints);

      std::size_t firings_seen = block.empty_firings;
      RC_ASSERT(firings_seen <= type.firings);
      for (const sensor::Point& point : block.points) {
        RC_ASSERT(point.line < 6);
        RC_ASSERT(point.echo < 3);
        RC_ASSERT(Duration{point.offset_ns} < block.duration);
        const double range_m = std::hypot(point.x_m, point.y_m, point.z_m);
        RC_ASSERT(range_m > 0.0999 && range_m < 460.1);
      }
      const LivoxCounters& counters = sut.counters();
      RC_ASSERT(block.empty_firings + block.points.size() + counters.out_of_range +
                    counters.bad_angles >=
                type.firings);
      RC_ASSERT(counters.points == block.points.size());
    }
  }));
}

TEST_F(LivoxDecoderTest, SurvivesAnyBytesAndCountsEachDatagramOnce) {
  std::mt19937 random(7);
  std::uint64_t datagrams = 0;
  for (int round = 0; round < 20'000; ++round) {
    const TypeSize& type = kPointTypes[random() % std::size(kPointTypes)];
    Bytes packet = round % 3 == 0 ? Bytes(random() % 1500) : empty_packet(type);
    const std::size_t changes = round % 3 == 0 ? packet.size() : random() % 8;
    for (std::size_t i = 0; i < changes && !packet.empty(); ++i) {
      packet[random() % std::min<std::size_t>(packet.size(), 40)] =
          static_cast<std::byte>(random());
    }

    decode(packet);
    ++datagrams;
  }

  std::uint64_t counted = 0;
  for (const std::uint64_t count : sut_.counters().packets) {
    counted += count;
  }
  EXPECT_EQ(counted, datagrams);
}

TEST_F(LivoxDecoderTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::vector<Bytes> packets = {from_hex(kImuPacket), from_hex(kHeartbeat), Bytes(3)};
  for (const TypeSize& type : kPointTypes) {
    packets.push_back(empty_packet(type));
    std::fill(packets.back().begin() + 18, packets.back().end(), std::byte{1});
  }

  const std::size_t allocations = support::count_allocations([&] {
    for (const Bytes& packet : packets) {
      decode(packet);
    }
  });

  EXPECT_EQ(allocations, 0U);
}

// Real Avia frames (driver output): packed again as type 2, each return must come out with the line
// byte that the vendor's driver gave it.
TEST_F(LivoxDecoderTest, GivesRealFramesTheLinesOfTheVendorsDriver) {
  const std::filesystem::path folder =
      std::filesystem::path(SLAMD_SHARED_DATA_DIR) / "livox_avia_pcd10";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << folder << " is not there";
  }
  constexpr std::size_t kRecord = 18;  // x y z intensity (float), tag, line
  std::size_t returns = 0;
  for (int frame = 1; frame <= 10; ++frame) {
    std::ifstream stream(folder / (std::to_string(frame) + ".pcd"), std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    const std::string all = text.str();
    const std::size_t begin = all.find("DATA binary\n") + 12;
    ASSERT_GE(all.size() - begin, 24'000 * kRecord);  // some writers fill the last page
    const auto bytes = std::as_bytes(std::span(all)).subspan(begin);
    for (std::size_t p = 0; p < 250; ++p) {
      Bytes packet = packet_of(2);
      std::vector<std::size_t> valid;
      for (std::size_t i = 0; i < 96; ++i) {
        const auto record = bytes.subspan((p * 96 + i) * kRecord, kRecord);
        ASSERT_EQ(load_le<std::uint8_t>(record, 17), i % 6);
        bool any = false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto mm =
              static_cast<std::int32_t>(std::lround(load_le<float>(record, 4 * axis) * 1e3F));
          store_le(packet, 18 + 14 * i + 4 * axis, mm);
          any = any || mm != 0;
        }
        packet[18 + 14 * i + 12] = static_cast<std::byte>(load_le<float>(record, 12));
        packet[18 + 14 * i + 13] = record[16];
        if (any) {
          valid.push_back((p * 96 + i) * kRecord);
        }
      }

      ASSERT_EQ(decode(packet), DecodeResult::kPoints);

      ASSERT_EQ(block_.points.size(), valid.size());
      ASSERT_EQ(block_.empty_firings, 96 - valid.size());
      for (std::size_t k = 0; k < valid.size(); ++k) {
        const auto record = bytes.subspan(valid[k], kRecord);
        EXPECT_EQ(block_.points[k].line, load_le<std::uint8_t>(record, 17));
        EXPECT_EQ(block_.points[k].tag, 0x10);
        EXPECT_NEAR(block_.points[k].x_m, load_le<float>(record, 0), 1e-3);
      }
      returns += valid.size();
    }
  }
  EXPECT_GT(returns, 10'000U);
}

}  // namespace
}  // namespace slamd::livox
