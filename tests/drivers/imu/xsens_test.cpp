#include "drivers/imu/xsens.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "core/base/bytes.hpp"
#include "stream_bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::imu {
namespace {

constexpr Stamp kReceived{std::chrono::seconds{1'548'000'000}};

// The golden vectors of imu-serial.md: bytes that a real device has sent, in each number format.
struct Golden {
  std::string_view hex;
  std::int64_t ticks;
  Eigen::Vector3d force_mps2;
  Eigen::Vector3d rate_radps;
};

const Golden kGolden[] = {
    {"FAFF3662102002A9861060040314ED5310100C07440BE007E301140D2F1837E020040180000740200CBC8E5466C0E82F10BF9AD29E40100CB9"
     "35269FBD949930BC46234680200CBB425C343B1068DF3AE1C7E58030103F800001B778C7F03738D82737107FEEF7",
     51703123, {-0.0173742, -7.2557449, -1.2095525}, {-0.0029657, 0.0022035, 0.0017226}},
    {"FAFF365F102002A9EA106004031518DA10100C0E14204007E301140D2F1937E010010540210C00007D65FF8BB2CAFFEBFC2E40110C00000141"
     "FFFED645FFFFCCC580210CFFFFFB1B000003ACFFFFFFA680311000100001FFFFFFFA00000005000000006A",
     51714266, {0.0306139, -7.2688503, -1.2509327}, {-0.0011950, 0.0008965, -0.0000858}},
    {"FAFF3679102002AA4E1060040315446E10100C14F80AC007E301140D2F1A37E01001054022120BD2D9600000BC86A000FFF8C82AB000FFFE40"
     "1212001E139F0000ED67C100FFFFFCE1A784FFFF80221200479AD20000006D5FBF0000FF0A3905FFFF80321800000001000100005BA6000000"
     "008C010000FFFEC569FFFF5D",
     51725422, {0.046186052, -7.263570786, -1.218098640}, {0.001092602, 0.001668915, -0.003750263}},
    {"FAFF3693102002AAB210600403156FF210100C1BC38B4007E301140D2F1B37E01001054023183F7132F3A0000000C01D0038A0000000BFF367"
     "8D800000004013183F05F57A00000000BFB28F8020000000BF88D67F800000008023183F149ADE600000013F353D8280000000BF1850FDC000"
     "00008033203FF00000000000013E9A5FD4E00000003EBB3002E0000001BE9F1FFD00000000CF",
     51736562, {0.004198982, -7.250216007, -1.212781429}, {7.86017e-05, 0.000324101, -9.27596e-05}}};

constexpr std::string_view kWithoutInertialData =
    "FAFF3630102002AB1610600403159B541070040000143610100C225B2A8007E301140D2F1C37E020040180000530100400018C0D16";

constexpr std::string_view kCommands[] = {"FAFF3000D1", "FAFF1000F1", "FAFF000001", "FAFF3F00C2", "FAFF3100D0",
                                          "FAFFC0101020FFFF1060FFFF402001908020019073"};

std::vector<sensor::ImuReading> readings_of(XsensReader& reader, std::span<const std::byte> bytes) {
  std::vector<sensor::ImuReading> readings;
  reader.add(bytes, kReceived, [&](const sensor::ImuReading& reading) { readings.push_back(reading); });
  return readings;
}

/// A message of one sample, floats.
Bytes sample_of(std::uint16_t count, std::optional<std::uint32_t> ticks, std::uint32_t status = 0) {
  Bytes data = from_hex("102002000040200C0000000000000000411CE80A80200C3F0000000000000000000000E0200400000000");
  store_be(data, 3, count);
  store_be(data, data.size() - 4, status);
  if (ticks) {
    Bytes time = from_hex("10600400000000");
    store_be(time, 3, *ticks);
    data.insert(data.end(), time.begin(), time.end());
  }
  const XbusBytes bytes = write_xbus({xbus::kMtData2, data});
  return {bytes.begin(), bytes.end()};
}

TEST(Xsens, ReadsTheGoldenMessagesOfEachNumberFormat) {
  for (const Golden& golden : kGolden) {
    XsensReader sut;

    const auto readings = readings_of(sut, from_hex(golden.hex));

    ASSERT_EQ(readings.size(), 1U);
    EXPECT_EQ(readings[0].device_stamp.time_since_epoch(), golden.ticks * std::chrono::microseconds{100});
    EXPECT_EQ(readings[0].received, kReceived);
    EXPECT_LT((readings[0].specific_force_mps2 - golden.force_mps2).norm(), 1e-7);
    EXPECT_LT((readings[0].angular_rate_radps - golden.rate_radps).norm(), 1e-7);
  }
}

TEST(Xsens, GivesEveryGoldenMessageBackWhenEncodedAgain) {
  std::vector<std::string_view> all{kWithoutInertialData};
  all.insert(all.end(), std::begin(kCommands), std::end(kCommands));
  for (const Golden& golden : kGolden) {
    all.push_back(golden.hex);
  }
  for (const std::string_view hex : all) {
    const Bytes bytes = from_hex(hex);

    ASSERT_EQ(Xbus::inspect(bytes).verdict, FrameVerdict::kFrame);
    EXPECT_EQ(to_hex(write_xbus(Xbus::parse(bytes)).view()), hex);
  }
}

// The items of a sample, read and written again in the number format that they came in.
TEST(Xsens, WritesTheGoldenSamplesBackInEachNumberFormat) {
  constexpr XsensOutput kOutputs[][4] = {{{0x1020, 0}, {0x1060, 0}, {0x4020, 0}, {0x8020, 0}},
                                         {{0x1020, 0}, {0x1060, 0}, {0x4021, 0}, {0x8021, 0}},
                                         {{0x1020, 0}, {0x1060, 0}, {0x4022, 0}, {0x8022, 0}},
                                         {{0x1020, 0}, {0x1060, 0}, {0x4023, 0}, {0x8023, 0}}};
  std::uint8_t formats = 0;
  for (const Golden& golden : kGolden) {
    XsensReader reader;
    const auto readings = readings_of(reader, from_hex(golden.hex));
    ASSERT_EQ(readings.size(), 1U);
    const std::string hex(golden.hex);

    for (const auto& outputs : kOutputs) {
      const XbusBytes sut = write_sample(outputs, {0, static_cast<std::uint32_t>(golden.ticks),
                                                   readings[0].specific_force_mps2, readings[0].angular_rate_radps});
      // The items stand in the golden message as they are written here, where the format is the same.
      const std::string written = to_hex(sut.view());
      const std::string force = written.substr(written.find("402" + std::to_string(outputs[2].data_id & 3)));
      const std::size_t item_digits = 2 * (3 + 3 * (outputs[2].data_id & 2 ? (outputs[2].data_id & 1 ? 8 : 6) : 4));
      if (hex.find(force.substr(0, 6)) != std::string::npos) {
        ++formats;
        EXPECT_NE(hex.find(force.substr(0, item_digits)), std::string::npos) << force;
        EXPECT_NE(hex.find(force.substr(item_digits, item_digits)), std::string::npos) << force;
      }
    }
  }
  EXPECT_EQ(formats, 4);
}

TEST(Xsens, ReadsBackTheSampleThatItWrites) {
  constexpr XsensOutput kOutputs[] = {{mt::kPacketCounter, mt::kFastest}, {mt::kSampleTimeFine, mt::kFastest},
                                      {mt::kAcceleration | 3, 400}, {mt::kRateOfTurn | 3, 400}, {mt::kStatusWord, mt::kFastest}};
  XsensReader sut;

  const auto readings = readings_of(sut, write_sample(kOutputs, {7, 1234, {0.1, -0.2, 9.8}, {-1.5, 0.3, 1e-5}, true}).view());

  ASSERT_EQ(readings.size(), 1U);
  EXPECT_EQ(readings[0].device_stamp.time_since_epoch(), std::chrono::microseconds{123'400});
  EXPECT_EQ(readings[0].specific_force_mps2, Eigen::Vector3d(0.1, -0.2, 9.8));
  EXPECT_EQ(readings[0].angular_rate_radps, Eigen::Vector3d(-1.5, 0.3, 1e-5));
  EXPECT_EQ(sut.counters().clipped, 1U);
}

TEST(Xsens, BuildsTheGoldenOutputConfiguration) {
  constexpr XsensOutput kOutputs[] = {{0x1020, 0xFFFF}, {0x1060, 0xFFFF}, {0x4020, 400}, {0x8020, 400}};

  EXPECT_EQ(to_hex(write_output_configuration(kOutputs).view()), kCommands[5]);
}

TEST(Xsens, WritesLongMessagesInTheExtendedForm) {
  for (const std::size_t size : {254U, 255U, 300U}) {
    const Bytes data(size, std::byte{7});

    const XbusBytes sut = write_xbus({xbus::kSetOutputConfiguration, data});

    EXPECT_EQ(sut.size(), size + (size < 255 ? 5 : 7));
    ASSERT_EQ(Xbus::inspect(sut.view()).verdict, FrameVerdict::kFrame);
    EXPECT_EQ(Xbus::parse(sut.view()).data.size(), size);
  }
}

TEST(Xsens, PassesOverMessagesWithoutInertialData) {
  XsensReader sut;

  EXPECT_TRUE(readings_of(sut, from_hex(kWithoutInertialData)).empty());
  EXPECT_TRUE(readings_of(sut, from_hex(kCommands[4])).empty());

  EXPECT_EQ(sut.counters().of(InertialResult::kOther), 2U);
  EXPECT_EQ(sut.stream().skipped_bytes, 0U);
}

TEST(Xsens, RefusesEveryFlippedBit) {
  for (const Golden& golden : kGolden) {
    const Bytes good = from_hex(golden.hex);
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      Bytes bytes = good;
      bytes[bit / 8] ^= std::byte{1} << bit % 8;

      ASSERT_NE(Xbus::inspect(bytes).verdict, FrameVerdict::kFrame) << bit;
    }
  }
}

TEST(Xsens, LosesNoOtherSampleThanTheDamagedOnes) {
  Bytes stream;
  for (std::uint16_t i = 0; i < 300; ++i) {
    Bytes sample = sample_of(i, 25U * i);
    if (i % 10 == 3) {
      sample[20] ^= std::byte{0x40};
    } else if (i % 10 == 6) {
      sample.resize(15);  // cut off
    } else if (i % 10 == 8) {
      const Bytes garbage = from_hex("00FA13FAFF367755");
      stream.insert(stream.end(), garbage.begin(), garbage.end());
    }
    stream.insert(stream.end(), sample.begin(), sample.end());
  }
  stream.resize(stream.size() + Xbus::kLongest);  // what garbage announces comes to its end
  XsensReader sut;
  std::size_t samples = 0;

  in_pieces(stream, 70, [&](std::span<const std::byte> piece) { samples += readings_of(sut, piece).size(); });

  EXPECT_EQ(samples, 240U);
  EXPECT_EQ(sut.counters().missing, 60U);
  EXPECT_EQ(sut.stream().frame_bytes + sut.stream().skipped_bytes + sut.pending(), stream.size());
}

TEST(Xsens, TakesNoMessageWhoseItemsDoNotFillItWhateverItsChecksumSays) {
  const Bytes cut = from_hex("106004000000FF40200C00000000");

  EXPECT_EQ(Xbus::inspect(write_xbus({xbus::kMtData2, cut}).view()).verdict, FrameVerdict::kDamaged);
}

TEST(Xsens, CarriesTheTimeOnOverTheWrapOfItsTicks) {
  XsensReader sut;
  const auto before = readings_of(sut, sample_of(1, 0xFFFFFFF0));
  const auto after = readings_of(sut, sample_of(2, 0x00000010));

  ASSERT_TRUE(before.size() == 1 && after.size() == 1);
  EXPECT_EQ(after[0].device_stamp - before[0].device_stamp, std::chrono::microseconds{3200});
}

TEST(Xsens, CountsTimeBySamplesWhereTheDeviceSendsNone) {
  XsensReader sut(std::chrono::microseconds{2500});
  const auto first = readings_of(sut, sample_of(65'535, std::nullopt));
  const auto second = readings_of(sut, sample_of(2, std::nullopt));

  ASSERT_TRUE(first.size() == 1 && second.size() == 1);
  EXPECT_EQ(second[0].device_stamp - first[0].device_stamp, std::chrono::microseconds{7500});
  EXPECT_EQ(sut.counters().missing, 2U);
}

TEST(Xsens, RefusesSamplesOfWhichNothingTellsTheTime) {
  XsensReader sut;

  EXPECT_TRUE(readings_of(sut, sample_of(1, std::nullopt)).empty());

  EXPECT_EQ(sut.counters().of(InertialResult::kNoTime), 1U);
}

TEST(Xsens, CountsSamplesAtTheDevicesLimits) {
  XsensReader sut;

  readings_of(sut, sample_of(1, 0));
  readings_of(sut, sample_of(2, 25, 1U << 19));

  EXPECT_EQ(sut.counters().clipped, 1U);
}

TEST(Xsens, RefusesWhatIsNoSampleByName) {
  const auto result_of = [](Bytes data) {
    XsensReader sut;
    sensor::ImuReading reading;
    return sut.take({xbus::kMtData2, data}, reading);
  };
  Bytes infinite = from_hex("106004000000FF40200C0000000000000000411CE80A80200C7F8000000000000000000000");
  Bytes fast = from_hex("106004000000FF40200C0000000000000000411CE80A80200C447A00000000000000000000");
  const Bytes force_only = from_hex("106004000000FF40200C0000000000000000411CE80A");
  const Bytes cut = from_hex("106004000000FF40200C00000000");
  const Bytes wrong_size = from_hex("106004000000FF40200800000000000000008020080000000000000000");

  EXPECT_EQ(result_of(infinite), InertialResult::kNotFinite);
  EXPECT_EQ(result_of(fast), InertialResult::kOutOfRange);  // 1000 rad/s
  EXPECT_EQ(result_of(force_only), InertialResult::kIncomplete);
  EXPECT_EQ(result_of(cut), InertialResult::kMalformed);
  EXPECT_EQ(result_of(wrong_size), InertialResult::kMalformed);
  EXPECT_STREQ(name_of(InertialResult::kOutOfRange), "out_of_range");
}

TEST(Xsens, RemembersTheErrorThatADeviceReports) {
  XsensReader sut;
  const Bytes code{std::byte{0x1E}};

  readings_of(sut, write_xbus({xbus::kError, code}).view());

  EXPECT_EQ(sut.device_error(), 0x1E);
}

TEST(Xsens, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Bytes golden = from_hex(kGolden[2].hex);
  XsensReader sut;
  std::size_t samples = 0;

  const std::size_t allocations = support::count_allocations([&] {
    sut.add(golden, kReceived, [&](const sensor::ImuReading&) { ++samples; });
  });

  EXPECT_EQ(samples, 1U);
  EXPECT_EQ(allocations, 0U);
}

/// What the published decoding says of one name, all its numbers in order.
std::vector<double> published(const std::string& text, const std::string& name) {
  std::vector<double> numbers;
  std::istringstream lines(text);
  bool wanted = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("  ", 0) != 0) {
      wanted = line.rfind(name, 0) == 0;
    } else if (wanted) {
      const std::size_t colon = line.find(':');
      numbers.push_back(std::stod(line.substr(colon == std::string::npos ? 0 : colon + 1)));
    }
  }
  return numbers;
}

// Streams that a real MTi has sent, and what another decoder says of them.
TEST(Xsens, DecodesRealCapturesToTheirPublishedValuesWithNoUnexplainedByte) {
  const auto folder = std::filesystem::path(SLAMD_SHARED_DATA_DIR) / "imu_gnss/xsens_go";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << folder << " is not there";
  }
  std::size_t samples = 0;
  for (const char* name : {"1", "2", "3", "4", "5"}) {
    const Bytes stream = bytes_of(folder / name / "output.bin");
    const std::string text = text_of(folder / name / "output.golden");
    XsensReader sut;
    std::vector<sensor::ImuReading> readings;

    in_pieces(stream, 300, [&](std::span<const std::byte> piece) {
      const auto more = readings_of(sut, piece);
      readings.insert(readings.end(), more.begin(), more.end());
    });

    EXPECT_EQ(sut.stream().frames, published(text, "PacketCounter:").size());
    EXPECT_EQ(sut.stream().frame_bytes, stream.size());
    EXPECT_EQ(sut.stream().skipped_bytes + sut.pending(), 0U);
    EXPECT_EQ(sut.counters().missing, 0U);
    const std::vector<double> force = published(text, "Acceleration(");
    const std::vector<double> rate = published(text, "RateOfTurn(");
    ASSERT_EQ(force.size(), 3 * readings.size()) << name;
    ASSERT_EQ(rate.size(), 3 * readings.size()) << name;
    for (std::size_t i = 0; i < force.size(); ++i) {
      const auto axis = static_cast<Eigen::Index>(i % 3);
      EXPECT_NEAR(readings[i / 3].specific_force_mps2[axis], force[i], 1e-12);
      EXPECT_NEAR(readings[i / 3].angular_rate_radps[axis], rate[i], 1e-12);
    }
    samples += readings.size();
  }
  EXPECT_EQ(samples, 4U * 96U);
}

}  // namespace
}  // namespace slamd::imu
