#include "drivers/velodyne/decoder.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <set>
#include <string>

#include "made_packet.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::velodyne {
namespace {

using namespace std::chrono_literals;

constexpr Stamp kReceived{std::chrono::seconds{1'700'000'001}};

constexpr std::uint8_t kHdl32eByte = 0x21;
constexpr std::uint8_t kVlp16Byte = 0x22;
constexpr std::uint8_t kHiResByte = 0x24;
constexpr std::uint8_t kVlp32cByte = 0x28;
constexpr std::uint8_t kProducts[] = {kHdl32eByte, kVlp16Byte, kHiResByte, kVlp32cByte};

class VelodyneDecoderTest : public testing::Test {
 protected:
  DecodeResult decode(const MadePacket& packet) { return sut_.decode(packet.bytes(), kReceived, block_); }

  Decoder sut_{DecoderConfig{}};
  sensor::PointBlock block_;
};

/// The lasers of a VLP-16 interleave: even ones from -15° up, odd ones from 1° up, two degrees apart.
double vlp16_elevation_deg(int laser) { return laser % 2 == 0 ? laser - 15.0 : laser; }

double hdl32e_elevation_deg(int laser) { return (laser % 2 == 0 ? -30.67 : -9.33) + 4.0 / 3.0 * (laser / 2); }

TEST_F(VelodyneDecoderTest, GivesEachFiringOfAVlp16ItsOwnTimeAndDirection) {
  const MadePacket packet = MadePacket(kStrongest, kVlp16Byte).turn(1000, 40).fill(5000, 77);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  ASSERT_EQ(block_.points.size(), 384U);
  ASSERT_EQ(block_.sequences.size(), 24U);
  for (int sequence = 0; sequence < 24; ++sequence) {
    EXPECT_EQ(block_.sequences[static_cast<std::size_t>(sequence)].first_point, 16 * sequence);
    EXPECT_EQ(block_.sequences[static_cast<std::size_t>(sequence)].azimuth_cdeg, 1000 + 20 * sequence);
    EXPECT_EQ(block_.sequences[static_cast<std::size_t>(sequence)].offset_ns, 55'296U * sequence);
    for (int laser = 0; laser < 16; ++laser) {
      const sensor::Point& point = block_.points[static_cast<std::size_t>(16 * sequence + laser)];
      const Direction direction = direction_of(point);
      const double time_us = 55.296 * sequence + 2.304 * laser;
      EXPECT_NEAR(point.offset_ns, 1e3 * time_us, 0.51);
      EXPECT_NEAR(direction.range_m, 10.0, 1e-5);
      EXPECT_NEAR(direction.azimuth_deg, 10.0 + 0.40 * time_us / 110.592, 0.0051);
      EXPECT_NEAR(direction.elevation_deg, vlp16_elevation_deg(laser), 1e-4);
      EXPECT_EQ(point.line, laser % 2 == 0 ? laser / 2 : 8 + laser / 2);
      EXPECT_EQ(point.intensity, 77);
      EXPECT_EQ(point.echo, 0);
      EXPECT_EQ(point.tag, 0);
    }
  }
}

TEST_F(VelodyneDecoderTest, GivesEachFiringOfAnHdl32eItsOwnTimeAndDirection) {
  const MadePacket packet = MadePacket(kStrongest, kHdl32eByte).turn(9000, 16).fill(5000, 1);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  ASSERT_EQ(block_.points.size(), 384U);
  ASSERT_EQ(block_.sequences.size(), 12U);
  EXPECT_EQ(block_.duration, 552'960ns);
  for (int sequence = 0; sequence < 12; ++sequence) {
    for (int laser = 0; laser < 32; ++laser) {
      const sensor::Point& point = block_.points[static_cast<std::size_t>(32 * sequence + laser)];
      const Direction direction = direction_of(point);
      EXPECT_NEAR(point.offset_ns, 1e3 * (46.080 * sequence + 1.152 * laser), 0.51);
      EXPECT_NEAR(direction.range_m, 10.0, 1e-5);
      EXPECT_NEAR(direction.azimuth_deg, 90.0 + 0.16 * (sequence + 1.152 * laser / 46.080), 0.0051);
      EXPECT_NEAR(direction.elevation_deg, hdl32e_elevation_deg(laser), 1e-4);
      EXPECT_EQ(point.line, laser % 2 == 0 ? laser / 2 : 16 + laser / 2);
    }
  }
}

TEST_F(VelodyneDecoderTest, FiresTheLasersOfAVlp32cInPairs) {
  const MadePacket packet = MadePacket(kStrongest, kVlp32cByte).turn(27000, 20).fill(2500, 1);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  ASSERT_EQ(block_.points.size(), 384U);
  EXPECT_EQ(block_.duration, 663'552ns);
  for (int sequence = 0; sequence < 12; ++sequence) {
    std::set<int> rings;
    for (int laser = 0; laser < 32; ++laser) {
      const sensor::Point& point = block_.points[static_cast<std::size_t>(32 * sequence + laser)];
      EXPECT_NEAR(point.offset_ns, 1e3 * (55.296 * sequence + 2.304 * (laser / 2)), 0.51);
      EXPECT_NEAR(direction_of(point).range_m, 10.0, 1e-5);  // 4 mm a count
      rings.insert(point.line);
    }
    EXPECT_EQ(rings.size(), 32U);
    EXPECT_EQ(*rings.rbegin(), 31);
  }
}

TEST_F(VelodyneDecoderTest, SubtractsTheAzimuthOffsetsOfAVlp32c) {
  const MadePacket packet = MadePacket(kStrongest, kVlp32cByte).turn(27000, 20).fill(2500, 1);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  EXPECT_NEAR(direction_of(block_.points[0]).azimuth_deg, 270.0 + 1.4, 0.0051);
  EXPECT_NEAR(direction_of(block_.points[0]).elevation_deg, -25.0, 1e-4);
  EXPECT_EQ(block_.points[0].line, 0);
  EXPECT_NEAR(direction_of(block_.points[1]).azimuth_deg, 270.0 - 4.2, 0.0051);
  EXPECT_NEAR(direction_of(block_.points[1]).elevation_deg, -1.0, 1e-4);
  EXPECT_NEAR(direction_of(block_.points[29]).azimuth_deg, 270.0 - 1.4 + 0.20 * 2.304 * 14 / 55.296, 0.0051);
  EXPECT_NEAR(direction_of(block_.points[29]).elevation_deg, 15.0, 1e-4);
  EXPECT_EQ(block_.points[29].line, 31);
}

TEST_F(VelodyneDecoderTest, KnowsThePuckHiResByItsProductByte) {
  const MadePacket packet = MadePacket(kStrongest, kHiResByte).fill(5000, 1);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  ASSERT_EQ(block_.points.size(), 384U);
  EXPECT_NEAR(direction_of(block_.points[0]).elevation_deg, -10.0, 1e-4);
  EXPECT_EQ(block_.points[0].line, 0);
  EXPECT_NEAR(direction_of(block_.points[1]).elevation_deg, 0.667, 1e-4);
  EXPECT_EQ(block_.points[1].line, 8);
  EXPECT_NEAR(direction_of(block_.points[15]).elevation_deg, 10.0, 1e-4);
  EXPECT_EQ(block_.points[15].line, 15);
}

TEST_F(VelodyneDecoderTest, AppliesTheVerticalParallaxOnRequestOnly) {
  Decoder with({.model = std::nullopt, .vertical_parallax = true});
  sensor::PointBlock corrected;
  const MadePacket packet = MadePacket(kStrongest, kVlp16Byte).fill(5000, 1);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);
  ASSERT_EQ(with.decode(packet.bytes(), kReceived, corrected), DecodeResult::kOk);

  EXPECT_NEAR(corrected.points[0].z_m - block_.points[0].z_m, 0.0112, 1e-5);
  EXPECT_NEAR(corrected.points[15].z_m - block_.points[15].z_m, -0.0112, 1e-5);
  EXPECT_EQ(corrected.points[0].x_m, block_.points[0].x_m);
}

TEST_F(VelodyneDecoderTest, KeepsTheDeviceStampAndTheArrival) {
  ASSERT_EQ(decode(MadePacket(kLast, kVlp16Byte).stamp(3'599'999'999U)), DecodeResult::kOk);

  EXPECT_EQ(block_.device_stamp.time_since_epoch(), 3'599'999'999us);
  EXPECT_EQ(block_.received, kReceived);
  EXPECT_EQ(block_.stamp, Stamp{});
  EXPECT_EQ(block_.duration, 1'327'104ns);
  EXPECT_EQ(sut_.report().last_return_mode, kLast);
}

TEST_F(VelodyneDecoderTest, CountsFiringsWithoutAReturn) {
  const MadePacket packet = MadePacket(kStrongest, kVlp16Byte).put(3, 17, 250, 9);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  ASSERT_EQ(block_.points.size(), 1U);
  EXPECT_EQ(block_.empty_firings, 383U);
  EXPECT_EQ(block_.sequences[7].first_point, 0);
  EXPECT_EQ(block_.sequences[8].first_point, 1);
  EXPECT_NEAR(block_.points[0].offset_ns, 1e3 * (7 * 55.296 + 2.304), 0.51);
}

TEST_F(VelodyneDecoderTest, InterpolatesAcrossTheWrap) {
  const MadePacket packet = MadePacket(kStrongest, kVlp16Byte).turn(35970, 40).fill(5000, 1);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  EXPECT_EQ(block_.sequences[0].azimuth_cdeg, 35970);
  EXPECT_EQ(block_.sequences[1].azimuth_cdeg, 35990);
  EXPECT_EQ(block_.sequences[2].azimuth_cdeg, 10);
  EXPECT_EQ(block_.sequences[3].azimuth_cdeg, 30);
  for (int i = 0; i < 64; ++i) {
    const double time_us = 55.296 * (i / 16) + 2.304 * (i % 16);
    const double turned_deg = 359.70 + 0.40 * time_us / 110.592;
    const Direction direction = direction_of(block_.points[static_cast<std::size_t>(i)]);
    EXPECT_NEAR(std::remainder(direction.azimuth_deg - turned_deg, 360.0), 0.0, 0.0051) << i;
  }
}

TEST_F(VelodyneDecoderTest, UsesEachGapForItsOwnBlockAndTheLastAgain) {
  MadePacket packet = MadePacket(kStrongest, kVlp16Byte).turn(1000, 40);
  packet.azimuth(10, 1000 + 9 * 40 + 38).azimuth(11, 1000 + 9 * 40 + 38 + 44);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  EXPECT_EQ(block_.sequences[19].azimuth_cdeg, 1360 + 19);
  EXPECT_EQ(block_.sequences[21].azimuth_cdeg, 1398 + 22);
  EXPECT_EQ(block_.sequences[23].azimuth_cdeg, 1442 + 22);
}

TEST_F(VelodyneDecoderTest, InterpolatesGapsOfOneAndAHalfDegreesAndNoLongerOnes) {
  MadePacket longest = MadePacket(kStrongest, kVlp16Byte).turn(1000, 40).azimuth(0, 890);
  MadePacket too_long = MadePacket(kStrongest, kVlp16Byte).turn(1000, 40).azimuth(0, 889);

  ASSERT_EQ(decode(longest), DecodeResult::kOk);
  EXPECT_EQ(block_.sequences[1].azimuth_cdeg, 890 + 75);
  ASSERT_EQ(decode(too_long), DecodeResult::kOk);
  EXPECT_EQ(block_.sequences[1].azimuth_cdeg, 889 + 20);
}

TEST_F(VelodyneDecoderTest, DoesNotInterpolateAcrossAHoleOrBackward) {
  MadePacket hole = MadePacket(kStrongest, kVlp16Byte).turn(1000, 40);
  hole.azimuth(0, 840);  // 1.6 degrees
  MadePacket backward = MadePacket(kStrongest, kVlp16Byte).turn(1000, 40);
  backward.azimuth(6, 1199);  // one behind block 5

  ASSERT_EQ(decode(hole), DecodeResult::kOk);
  EXPECT_EQ(block_.sequences[1].azimuth_cdeg, 860);
  ASSERT_EQ(decode(backward), DecodeResult::kOk);
  EXPECT_EQ(block_.sequences[11].azimuth_cdeg, 1220);
}

// A field of view from 270 to 90 degrees: one packet a turn ends one sweep and begins the next.
TEST_F(VelodyneDecoderTest, LetsTheTimePassThatASectorLeftOutTakes) {
  MadePacket packet = MadePacket(kStrongest, kVlp16Byte).turn(8921, 40).fill(5000, 1);
  for (std::size_t block = 3; block < 12; ++block) {
    packet.azimuth(block, 27000 + 40 * static_cast<int>(block - 3));
  }
  // At 600 rpm from 90.01 to 270.00 degrees: 49.997 ms, 452 blocks of 110.592 us.
  constexpr double kBehind_us = 452 * 110.592;

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  EXPECT_NEAR(block_.points[95].offset_ns, 1e3 * (5 * 55.296 + 15 * 2.304), 0.51);
  EXPECT_NEAR(block_.points[96].offset_ns, 1e3 * (2 * 110.592 + kBehind_us), 0.51);
  EXPECT_EQ(block_.sequences[6].azimuth_cdeg, 27000);
  EXPECT_NEAR(block_.sequences[6].offset_ns, 1e3 * (2 * 110.592 + kBehind_us), 0.51);
  EXPECT_NEAR(static_cast<double>(block_.duration.count()), 1e3 * (11 * 110.592 + kBehind_us), 1.0);
  EXPECT_EQ(block_.sequences[5].azimuth_cdeg, 8921 + 2 * 40 + 20);  // the head turned on
}

TEST_F(VelodyneDecoderTest, LetsNoTimePassForAzimuthsThatJumpToAndFro) {
  MadePacket jumping = MadePacket(kStrongest, kVlp16Byte).turn(1000, 40).azimuth(5, 20000);
  MadePacket trembling = MadePacket(kStrongest, kVlp16Byte).turn(1000, 40).azimuth(5, 1159);

  for (const MadePacket& packet : {jumping, trembling}) {
    ASSERT_EQ(decode(packet), DecodeResult::kOk);
    EXPECT_EQ(block_.duration, 1'327'104ns);
    EXPECT_EQ(block_.sequences[23].offset_ns, 23U * 55'296);
  }
}

TEST_F(VelodyneDecoderTest, GivesBothReturnsOfAFiringItsTimeAndDirection) {
  const MadePacket packet = MadePacket(kDual, kVlp16Byte).turn(1000, 40).put(2, 31, 1123, 12).put(3, 31, 367, 6);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  ASSERT_EQ(block_.points.size(), 2U);
  EXPECT_EQ(block_.empty_firings, 191U);
  EXPECT_EQ(block_.sequences.size(), 12U);
  EXPECT_EQ(block_.duration, 663'552ns);
  const sensor::Point& last = block_.points[0];
  const sensor::Point& strongest = block_.points[1];
  EXPECT_NEAR(direction_of(last).range_m, 2.246, 1e-5);
  EXPECT_EQ(last.intensity, 12);
  EXPECT_EQ(last.echo, 0);
  EXPECT_NEAR(direction_of(strongest).range_m, 0.734, 1e-5);
  EXPECT_EQ(strongest.intensity, 6);
  EXPECT_EQ(strongest.echo, 1);
  EXPECT_EQ(last.line, 15);
  EXPECT_EQ(strongest.line, 15);
  const double time_us = 3 * 55.296 + 15 * 2.304;  // the second pair's second sequence
  EXPECT_NEAR(last.offset_ns, 1e3 * time_us, 0.51);
  EXPECT_EQ(strongest.offset_ns, last.offset_ns);
  EXPECT_NEAR(direction_of(last).azimuth_deg, 10.0 + 0.40 * time_us / 110.592, 0.0051);
  EXPECT_NEAR(direction_of(strongest).azimuth_deg, direction_of(last).azimuth_deg, 1e-4);
}

TEST_F(VelodyneDecoderTest, TellsAReturnThatIsLastAndStrongestOnce) {
  const MadePacket packet = MadePacket(kDual, kVlp16Byte).fill(5000, 3);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  EXPECT_EQ(block_.points.size(), 192U);
  EXPECT_EQ(block_.empty_firings, 0U);
  EXPECT_TRUE(std::all_of(block_.points.begin(), block_.points.end(), [](const auto& p) { return p.echo == 0; }));
}

TEST_F(VelodyneDecoderTest, TakesTheOneReturnThatIsThere) {
  const MadePacket packet = MadePacket(kDual, kVlp16Byte).put(0, 0, 500, 1).put(1, 1, 600, 2);

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  ASSERT_EQ(block_.points.size(), 2U);
  EXPECT_EQ(block_.points[0].intensity, 1);
  EXPECT_EQ(block_.points[0].echo, 0);
  EXPECT_EQ(block_.points[1].intensity, 2);
  EXPECT_EQ(block_.points[1].echo, 0);
  EXPECT_EQ(block_.empty_firings, 190U);
}

TEST_F(VelodyneDecoderTest, HoldsEveryReturnOfADualPacket) {
  MadePacket packet = MadePacket(kDual, kVlp16Byte).fill(5000, 3);
  for (std::size_t block = 0; block < 12; block += 2) {
    for (std::size_t channel = 0; channel < 32; ++channel) {
      packet.put(block, channel, 9000, 4);
    }
  }

  ASSERT_EQ(decode(packet), DecodeResult::kOk);

  EXPECT_EQ(block_.points.size(), 384U);
  EXPECT_EQ(block_.sequences[1].first_point, 32);
}

TEST_F(VelodyneDecoderTest, RefusesEveryTruncationAndALongerPacket) {
  const MadePacket packet(kStrongest, kVlp16Byte);
  std::vector<std::byte> longer(packet.bytes().begin(), packet.bytes().end());
  longer.push_back({});

  for (std::size_t size = 0; size < Decoder::kPacketBytes; ++size) {
    ASSERT_EQ(sut_.decode(packet.bytes().first(size), kReceived, block_), DecodeResult::kWrongLength);
  }
  EXPECT_EQ(sut_.decode(longer, kReceived, block_), DecodeResult::kWrongLength);
  EXPECT_EQ(sut_.report().of(DecodeResult::kWrongLength), 1207U);
}

TEST_F(VelodyneDecoderTest, NamesEachRefusalByItsReasonAndChangesNothing) {
  ASSERT_EQ(decode(MadePacket(kStrongest, kVlp16Byte).put(0, 3, 1000, 5).stamp(1234)), DecodeResult::kOk);

  EXPECT_EQ(decode(MadePacket(kStrongest, kVlp16Byte).byte(1100, 0xFE)), DecodeResult::kBadBlockFlag);
  EXPECT_EQ(decode(MadePacket(kStrongest, kVlp16Byte).byte(1, 0xDD)), DecodeResult::kBadBlockFlag);
  EXPECT_EQ(decode(MadePacket(kStrongest, kVlp16Byte).azimuth(11, 36000)), DecodeResult::kBadAzimuth);
  EXPECT_EQ(decode(MadePacket(kStrongest, kVlp16Byte).stamp(3'600'000'000U)), DecodeResult::kBadTimestamp);
  EXPECT_EQ(decode(MadePacket(kStrongest, 0x31)), DecodeResult::kUnknownProduct);
  EXPECT_EQ(decode(MadePacket(0x36, kVlp16Byte)), DecodeResult::kUnknownReturnMode);

  for (std::size_t result = 0; result < kDecodeResults; ++result) {
    const auto reason = static_cast<DecodeResult>(result);
    const std::uint64_t expected =
        reason == DecodeResult::kWrongLength ? 0 : reason == DecodeResult::kBadBlockFlag ? 2 : 1;
    EXPECT_EQ(sut_.report().of(reason), expected) << name_of(reason);
  }
  EXPECT_EQ(block_.device_stamp.time_since_epoch(), 1234us);
  ASSERT_EQ(block_.points.size(), 1U);
  EXPECT_EQ(block_.points[0].intensity, 5);
  EXPECT_EQ(sut_.report().last_product, kVlp16Byte);
}

TEST_F(VelodyneDecoderTest, RefusesForeignPackets) {
  std::vector<std::byte> position(512);
  std::vector<std::byte> livox(1362, std::byte{5});
  std::vector<std::byte> zeros(Decoder::kPacketBytes);
  std::vector<std::byte> ones(Decoder::kPacketBytes, std::byte{0xFF});

  EXPECT_EQ(sut_.decode(position, kReceived, block_), DecodeResult::kWrongLength);
  EXPECT_EQ(sut_.decode(livox, kReceived, block_), DecodeResult::kWrongLength);
  EXPECT_EQ(sut_.decode(zeros, kReceived, block_), DecodeResult::kBadBlockFlag);
  EXPECT_EQ(sut_.decode(ones, kReceived, block_), DecodeResult::kBadBlockFlag);
}

TEST_F(VelodyneDecoderTest, NamesEveryResultDifferently) {
  std::set<std::string> names;
  for (std::size_t result = 0; result < kDecodeResults; ++result) {
    names.insert(name_of(static_cast<DecodeResult>(result)));
  }

  EXPECT_EQ(names.size(), kDecodeResults);
  EXPECT_EQ(names.count("?"), 0U);
}

TEST_F(VelodyneDecoderTest, DecodesAsTheConfiguredModelAndCountsTheOddProductByte) {
  Decoder sut({.model = Model::kVlp16, .vertical_parallax = false});
  const MadePacket odd = MadePacket(kStrongest, kHdl32eByte).fill(5000, 1);
  const MadePacket unheard_of = MadePacket(kStrongest, 0x00).fill(5000, 1);
  const MadePacket usual = MadePacket(kStrongest, kVlp16Byte).fill(5000, 1);

  for (const MadePacket& packet : {odd, unheard_of}) {
    ASSERT_EQ(sut.decode(packet.bytes(), kReceived, block_), DecodeResult::kOk);
    EXPECT_EQ(block_.sequences.size(), 24U);
    EXPECT_NEAR(direction_of(block_.points[0]).elevation_deg, -15.0, 1e-4);
  }
  EXPECT_EQ(sut.report().other_product, 2U);
  EXPECT_EQ(sut.report().last_product, 0x00);

  ASSERT_EQ(sut.decode(usual.bytes(), kReceived, block_), DecodeResult::kOk);
  EXPECT_EQ(sut.report().other_product, 2U);
}

TEST_F(VelodyneDecoderTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const MadePacket dual = MadePacket(kDual, kVlp16Byte).fill(5000, 3).put(2, 3, 100, 1);
  const MadePacket hdl = MadePacket(kStrongest, kHdl32eByte).fill(5000, 3);
  const MadePacket bad = MadePacket(kStrongest, 0x31);

  const std::size_t count = support::count_allocations([&] {
    decode(dual);
    decode(hdl);
    decode(bad);
  });

  EXPECT_EQ(count, 0U);
  EXPECT_EQ(sut_.report().of(DecodeResult::kOk), 2U);
}

/// What holds for every accepted packet, whatever its bytes.
void expect_sound(const sensor::PointBlock& block, bool dual) {
  const std::size_t firings = dual ? 192 : 384;
  RC_ASSERT(block.empty_firings <= firings);
  RC_ASSERT(block.points.size() >= firings - block.empty_firings);
  RC_ASSERT(block.points.size() <= (firings - block.empty_firings) * (dual ? 2 : 1));
  RC_ASSERT(block.duration > Duration::zero());
  std::size_t first_point = 0;
  for (const sensor::Sequence& sequence : block.sequences) {
    RC_ASSERT(sequence.azimuth_cdeg < 36000);
    RC_ASSERT(sequence.first_point >= first_point);
    RC_ASSERT(Duration{sequence.offset_ns} < block.duration);
    first_point = sequence.first_point;
  }
  RC_ASSERT(first_point <= block.points.size());
  std::uint32_t offset_ns = 0;
  for (const sensor::Point& point : block.points) {
    RC_ASSERT(point.line < 32);
    RC_ASSERT(point.echo < 2);
    RC_ASSERT(point.offset_ns >= offset_ns);
    RC_ASSERT(Duration{point.offset_ns} < block.duration);
    offset_ns = point.offset_ns;
    const double range_m = direction_of(point).range_m;
    RC_ASSERT(range_m > 0.0019 && range_m < 262.2);
  }
}

TEST_F(VelodyneDecoderTest, SurvivesAnyMutationAndAccountsForEveryFiring) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (const std::uint8_t product : kProducts) {
      for (const std::uint8_t mode : {kStrongest, kLast, kDual}) {
        Decoder sut{DecoderConfig{}};
        sensor::PointBlock block;
        MadePacket packet = MadePacket(mode, product).turn(static_cast<int>(random() % 36000), 20);
        for (std::size_t i = 0; i < 400; ++i) {
          packet.put(random() % 12, random() % 32, static_cast<std::uint16_t>(random()), 0);
        }
        for (std::size_t i = random() % 4; i > 0; --i) {
          packet.byte(random() % Decoder::kPacketBytes, static_cast<int>(random() % 256));
        }

        const DecodeResult result = sut.decode(packet.bytes(), kReceived, block);

        RC_ASSERT(sut.report().of(result) == 1);
        if (result == DecodeResult::kOk) {
          expect_sound(block, sut.report().last_return_mode == kDual);
        }
      }
    }
  }));
}

TEST_F(VelodyneDecoderTest, SurvivesEveryMutationOfASingleByte) {
  const MadePacket good = MadePacket(kDual, kVlp16Byte).turn(35900, 40).fill(5000, 3);
  std::uint64_t accepted = 0;

  for (std::size_t at = 0; at < Decoder::kPacketBytes; ++at) {
    for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFE, 0xFF}) {
      MadePacket packet = good;
      accepted += decode(packet.byte(at, value)) == DecodeResult::kOk ? 1 : 0;
    }
  }

  // Distances and reflectivities are free; of the rest most values are none.
  EXPECT_GE(accepted, 6U * 12 * 96);
  EXPECT_LT(accepted, 6U * Decoder::kPacketBytes);
}

TEST(VelodyneModel, NamesEveryModelAndKnowsNoForeignProduct) {
  EXPECT_STREQ(name_of(Model::kVlp16), "VLP-16");
  EXPECT_STREQ(name_of(Model::kVlp16HiRes), "Puck Hi-Res");
  EXPECT_STREQ(name_of(Model::kVlp32c), "VLP-32C");
  EXPECT_STREQ(name_of(Model::kHdl32e), "HDL-32E");
  int known = 0;
  for (int product = 0; product < 256; ++product) {
    known += model_of_product(static_cast<std::uint8_t>(product)) ? 1 : 0;
  }
  EXPECT_EQ(known, 4);
}

TEST(VelodyneModel, RanksTheRingsOfEveryModelFromTheLowest) {
  for (const Model model : {Model::kVlp16, Model::kVlp16HiRes, Model::kVlp32c, Model::kHdl32e}) {
    const ModelTable& table = table_of(model);
    std::vector<std::pair<int, double>> by_ring;
    for (std::size_t laser = 0; laser < static_cast<std::size_t>(table.lasers); ++laser) {
      by_ring.emplace_back(table.ring[laser], table.elevation_deg[laser]);
    }

    std::sort(by_ring.begin(), by_ring.end());

    for (std::size_t i = 0; i < by_ring.size(); ++i) {
      EXPECT_EQ(by_ring[i].first, static_cast<int>(i)) << name_of(model);
      EXPECT_TRUE(i == 0 || by_ring[i - 1].second < by_ring[i].second) << name_of(model);
    }
  }
}

}  // namespace
}  // namespace slamd::velodyne
