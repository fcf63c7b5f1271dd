#include "drivers/imu/mip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "core/base/bytes.hpp"
#include "stream_bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::imu {
namespace {

constexpr Stamp kReceived{std::chrono::seconds{1'700'000'000}};
constexpr double kG_mps2 = 9.80665;

// The golden vectors of imu-serial.md.
constexpr std::string_view kPing = "75650100DB05";
constexpr std::string_view kResumed = "7565010404F10600DA74";
constexpr std::string_view kFormat = "75650C0E0E0F018003D5000A04000A05000A91CE";
constexpr std::string_view kPoll = "75650C08080D008003D504056446";
constexpr std::string_view kSample =
    "756580300AD500000041D8BAE0400AD600000000007A12000E043C8EAF72BBDA6818BF7C52E80E05BB469CCF39A34C8BBB8BE12FD771";
constexpr std::string_view kMagnetic = "7565800E0E063D7AFFD63E919FE83E79FFD6EAC9";
constexpr std::string_view kWithDeltas =
    "7565804C0AD5000000055EE67CC00AD6000000014E434A000E043D9EE88D387FDB00BF7AAF030E05BB0C1E30BB572E68BBAA24AE0E07BC8AAC80BC"
    "72C50EBCC4E2C10E083EEE3D9FBD66DADDC0AFDEF59196";
constexpr std::string_view kAll[] = {kPing, kResumed, kFormat, kPoll, kSample, kMagnetic, kWithDeltas};

std::vector<sensor::ImuReading> readings_of(MipReader& reader, std::span<const std::byte> bytes) {
  std::vector<sensor::ImuReading> readings;
  reader.add(bytes, kReceived, [&](const sensor::ImuReading& reading) { readings.push_back(reading); });
  return readings;
}

/// A packet of one sample at a time, which says that the one before was delta_ns earlier.
Bytes sample_at(std::uint64_t time_ns, std::uint64_t delta_ns) {
  Bytes bytes = from_hex(kSample);
  store_be(bytes, 6, time_ns);
  store_be(bytes, 16, delta_ns);
  const MipBytes sealed = write_mip(Mip::parse(bytes));
  return {sealed.begin(), sealed.end()};
}

TEST(Mip, ReadsTheGoldenSamplesInSiUnits) {
  MipReader sut;
  const auto first = readings_of(sut, from_hex(kSample));
  MipReader another;
  const auto second = readings_of(another, from_hex(kWithDeltas));

  ASSERT_TRUE(first.size() == 1 && second.size() == 1);
  EXPECT_EQ(first[0].device_stamp.time_since_epoch().count(), 282'809'000'000);
  EXPECT_EQ(first[0].received, kReceived);
  EXPECT_LT((first[0].specific_force_mps2 / kG_mps2 - Eigen::Vector3d(0.01741764, -0.00666524, -0.98564005)).norm(), 1e-7);
  EXPECT_LT((first[0].angular_rate_radps - Eigen::Vector3d(-0.00303059, 0.00031147, -0.00426879)).norm(), 1e-7);
  EXPECT_EQ(second[0].device_stamp.time_since_epoch().count(), 23'067'000'000);
  EXPECT_LT((second[0].specific_force_mps2 / kG_mps2 - Eigen::Vector3d(0.0775920, 0.0000610, -0.9792330)).norm(), 1e-6);
}

TEST(Mip, GivesEveryGoldenPacketBackWhenEncodedAgain) {
  for (const std::string_view hex : kAll) {
    const Bytes bytes = from_hex(hex);

    ASSERT_EQ(Mip::inspect(bytes).verdict, FrameVerdict::kFrame) << hex;
    EXPECT_EQ(to_hex(write_mip(Mip::parse(bytes)).view()), hex);
  }
}

TEST(Mip, WritesTheGoldenSampleBack) {
  constexpr MipOutput kOutputs[] = {{0xD5}, {0xD6}, {0x04}, {0x05}};
  MipReader reader;
  const auto readings = readings_of(reader, from_hex(kSample));
  ASSERT_EQ(readings.size(), 1U);

  const MipBytes sut = write_sample(kOutputs, {282'809'000'000, 8'000'000, readings[0].specific_force_mps2,
                                               readings[0].angular_rate_radps});

  EXPECT_EQ(to_hex(sut.view()), kSample);
}

TEST(Mip, ReadsBackThatASampleIsAtTheDevicesLimits) {
  constexpr MipOutput kOutputs[] = {{mip::kReferenceTime}, {mip::kAcceleration}, {mip::kTurnRate}, {mip::kOverrange}};
  MipReader sut;

  EXPECT_EQ(readings_of(sut, write_sample(kOutputs, {.reference_time_ns = 1}).view()).size(), 1U);
  EXPECT_EQ(readings_of(sut, write_sample(kOutputs, {.reference_time_ns = 2, .clipped = true}).view()).size(), 1U);

  EXPECT_EQ(sut.counters().clipped, 1U);
}

TEST(Mip, BuildsTheGoldenMessageFormat) {
  constexpr MipOutput kOutputs[] = {{0xD5, 10}, {0x04, 10}, {0x05, 10}};

  EXPECT_EQ(to_hex(write_message_format(kOutputs).view()), kFormat);
}

TEST(Mip, ReadsAnswersAndRemembersARefusal) {
  const Bytes resumed = from_hex(kResumed);
  const auto ack = ack_of(Mip::parse(resumed));
  ASSERT_TRUE(ack);
  EXPECT_EQ(ack->command, 6);
  EXPECT_EQ(ack->code, 0);

  MipReader sut;
  const Bytes refused = from_hex("04F10F03");
  readings_of(sut, write_mip({0x0C, refused}).view());
  ASSERT_TRUE(sut.refusal());
  EXPECT_EQ(sut.refusal()->command, 0x0F);
  EXPECT_EQ(sut.refusal()->code, 3);
}

TEST(Mip, PassesOverPacketsWithoutInertialData) {
  MipReader sut;

  EXPECT_TRUE(readings_of(sut, from_hex(kMagnetic)).empty());
  EXPECT_TRUE(readings_of(sut, from_hex(kPing)).empty());

  EXPECT_EQ(sut.counters().of(InertialResult::kOther), 2U);
}

TEST(Mip, RefusesEveryFlippedBit) {
  for (const std::string_view hex : kAll) {
    const Bytes good = from_hex(hex);
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      Bytes bytes = good;
      bytes[bit / 8] ^= std::byte{1} << bit % 8;

      ASSERT_NE(Mip::inspect(bytes).verdict, FrameVerdict::kFrame) << hex << " bit " << bit;
    }
  }
}

TEST(Mip, LosesNoOtherSampleThanTheDamagedOnes) {
  Bytes stream;
  constexpr std::uint64_t kPeriod_ns = 8'000'000;
  for (std::uint64_t i = 0; i < 300; ++i) {
    Bytes sample = sample_at(1'000'000'000 + i * kPeriod_ns, kPeriod_ns);
    if (i % 10 == 3) {
      sample[20] ^= std::byte{0x40};
    } else if (i % 10 == 6) {
      sample.resize(15);  // cut off
    } else if (i % 10 == 8) {
      const Bytes garbage = from_hex("007575657575650180");
      stream.insert(stream.end(), garbage.begin(), garbage.end());
    }
    stream.insert(stream.end(), sample.begin(), sample.end());
  }
  stream.resize(stream.size() + Mip::kLongest);  // what garbage announces comes to its end
  MipReader sut;
  std::size_t samples = 0;

  in_pieces(stream, 70, [&](std::span<const std::byte> piece) { samples += readings_of(sut, piece).size(); });

  EXPECT_EQ(samples, 240U);
  EXPECT_EQ(sut.counters().missing, 60U);
  EXPECT_EQ(sut.stream().frame_bytes + sut.stream().skipped_bytes + sut.pending(), stream.size());
}

TEST(Mip, TakesGpsTimeWhereThereIsNoReferenceTime) {
  const Bytes fields =
      from_hex("0E0400000000000000003F800000" "0E05000000000000000000000000" "0E1241186A0000000000" "089A0007");
  MipReader sut;

  const auto readings = readings_of(sut, write_mip({0x80, fields}).view());

  ASSERT_EQ(readings.size(), 1U);
  EXPECT_EQ(readings[0].device_stamp.time_since_epoch(),
            std::chrono::hours{168} * 2202 + std::chrono::seconds{400'000});
}

TEST(Mip, TakesNoGpsTimeBeyondTheClock) {
  const Bytes fields =
      from_hex("0E0400000000000000003F800000" "0E05000000000000000000000000" "0E1241186A0000000000" "FFFF0007");
  MipReader sut;

  EXPECT_TRUE(readings_of(sut, write_mip({0x80, fields}).view()).empty());

  EXPECT_EQ(sut.counters().of(InertialResult::kNoTime), 1U);
}

TEST(Mip, RefusesWhatIsNoSampleByName) {
  const auto result_of = [](std::string_view hex) {
    MipReader sut;
    sensor::ImuReading reading;
    const Bytes payload = from_hex(hex);
    return sut.take({0x80, payload}, reading);
  };

  EXPECT_EQ(result_of("0E0400000000000000003F8000000E05000000000000000000000000"), InertialResult::kNoTime);
  EXPECT_EQ(result_of("0AD500000000000000FF0E0400000000000000003F800000"), InertialResult::kIncomplete);
  EXPECT_EQ(result_of("0AD500000000000000FF0E0400000000000000007F8000000E05000000000000000000000000"),
            InertialResult::kNotFinite);
  EXPECT_EQ(result_of("0AD500000000000000FF0E0400000000000000003F8000000E05447A00000000000000000000"),
            InertialResult::kOutOfRange);
  EXPECT_EQ(result_of("0AD500000000000000FF0E04000000"), InertialResult::kMalformed);
  EXPECT_EQ(result_of("00"), InertialResult::kMalformed);
  EXPECT_EQ(result_of("0604000000000605"), InertialResult::kMalformed);
}

TEST(Mip, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Bytes golden = from_hex(kSample);
  MipReader sut;
  std::size_t samples = 0;

  const std::size_t allocations = support::count_allocations([&] {
    sut.add(golden, kReceived, [&](const sensor::ImuReading&) { ++samples; });
  });

  EXPECT_EQ(samples, 1U);
  EXPECT_EQ(allocations, 0U);
}

// A stream that a real sensor has sent.
TEST(Mip, ExplainsEveryByteOfTheRealStream) {
  const auto file = std::filesystem::path(SLAMD_SHARED_DATA_DIR) / "imu_gnss/microstrain_mip/mip_data.bin";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << file << " is not there";
  }
  const Bytes stream = bytes_of(file);
  ByteFrames<Mip> frames;
  std::map<int, int> sets;
  MipReader sut;
  std::vector<sensor::ImuReading> readings;

  in_pieces(stream, 900, [&](std::span<const std::byte> piece) {
    frames.add(piece, [&](std::span<const std::byte> frame) { ++sets[Mip::parse(frame).set]; });
    const auto more = readings_of(sut, piece);
    readings.insert(readings.end(), more.begin(), more.end());
  });

  EXPECT_EQ(sets, (std::map<int, int>{{0x01, 1}, {0x80, 7157}, {0x82, 714}, {0xA0, 512}}));
  EXPECT_EQ(sut.stream().frames, 8384U);
  EXPECT_EQ(sut.stream().frame_bytes, stream.size());
  EXPECT_EQ(sut.stream().skipped_bytes + sut.pending(), 0U);
  EXPECT_EQ(sut.counters().of(InertialResult::kMalformed), 0U);
  ASSERT_GT(readings.size(), 1000U);
  EXPECT_EQ(sut.counters().missing, 0U);
  for (std::size_t i = 1; i < readings.size(); ++i) {
    ASSERT_GT(readings[i].device_stamp, readings[i - 1].device_stamp);
  }
  EXPECT_NEAR(readings[0].specific_force_mps2.norm(), 9.8, 0.3);
}

}  // namespace
}  // namespace slamd::imu
