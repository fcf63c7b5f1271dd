#include "drivers/recording/csv_reader.hpp"

#include <gtest/gtest.h>

#include "drivers/recording/packet.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::recording {
namespace {

using scratch::message_of;
using scratch::ScratchFolder;

constexpr const char* kHeader = "timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2\n";

class CsvReaderTest : public ScratchFolder {
 protected:
  std::vector<sensor::ImuSample> read_all(ImuCsvReader& reader) {
    std::vector<sensor::ImuSample> samples;
    sensor::ImuSample sample;
    while (reader.next(sample)) {
      samples.push_back(sample);
    }
    return samples;
  }

  static std::uint64_t refused(const ImuCsvReader& reader, RowRefusal reason) {
    return reader.counters().refused[static_cast<std::size_t>(reason)];
  }
};

TEST_F(CsvReaderTest, ReadsInertialSamplesToTheNanosecond) {
  ImuCsvReader sut(write("imu.csv",
                         std::string(kHeader) + "1700000000123456789,0.1,-0.2,3e-1,1,2,9.81\r\n" +
                             "1700000000128456789,1,2,3,4,5,6"));

  const auto samples = read_all(sut);

  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].stamp.time_since_epoch().count(), 1'700'000'000'123'456'789);
  EXPECT_EQ(samples[0].angular_rate_radps, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(samples[0].specific_force_mps2, Eigen::Vector3d(1.0, 2.0, 9.81));
  EXPECT_EQ(samples[1].specific_force_mps2.z(), 6.0);
  EXPECT_EQ(sut.counters().rows, 2U);
}

TEST_F(CsvReaderTest, FindsColumnsByNameAndIgnoresOthers) {
  ImuCsvReader sut(
      write("imu.csv",
            "temp_c, az_m_s2 ,ay_m_s2,ax_m_s2,gz_rad_s,gy_rad_s,gx_rad_s,timestamp_ns\n"
            "warm,6,5,4,3,2,1,77\n"));

  const auto samples = read_all(sut);

  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].angular_rate_radps, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(samples[0].specific_force_mps2, Eigen::Vector3d(4.0, 5.0, 6.0));
}

TEST_F(CsvReaderTest, PassesOverWildStampsAndGoesOn) {
  std::string rows = kHeader;
  for (int i = 0; i < 40; ++i) {
    const bool wild = i == 0 || i == 10 || i == 11 || i == 25;
    rows += std::to_string(1'700'000'000'000'000'000 + 5'000'000LL * i + (wild ? 3'600'000'000'000LL * (i == 25 ? -1 : 1) : 0)) +
            ",0,0,0,0,0,9.8\n";
  }
  ImuCsvReader sut(write("imu.csv", rows));

  const auto samples = read_all(sut);

  ASSERT_EQ(samples.size(), 36U);
  EXPECT_EQ(samples.back().stamp.time_since_epoch().count(), 1'700'000'000'195'000'000);
  EXPECT_EQ(refused(sut, RowRefusal::kTimeFarAhead), 3U);
  EXPECT_EQ(refused(sut, RowRefusal::kTimeNotIncreasing), 1U);
  EXPECT_EQ(sut.counters().first_refused_line, 2U);
}

TEST_F(CsvReaderTest, GoesOnWhereTheClockSteppedBackAndTakesAGapForOne) {
  std::string rows = kHeader;
  for (int i = 0; i < 60; ++i) {
    const std::int64_t step_ms = i < 20 ? 0 : i < 40 ? 10'000 : -7'200'000;  // 10 s without rows, then the clock goes back
    rows += std::to_string(1'700'000'000'000'000'000 + 5'000'000LL * i + 1'000'000LL * step_ms) + ",0,0,0,0,0,9.8\n";
  }
  ImuCsvReader sut(write("imu.csv", rows));

  const auto samples = read_all(sut);

  ASSERT_EQ(samples.size(), 60U);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].stamp - samples[i - 1].stamp, std::chrono::milliseconds(i == 20 ? 10'005 : 5));
  }
  EXPECT_EQ(sut.counters().steps_back, 1U);
}

TEST_F(CsvReaderTest, CountsBadRowsByReasonAndGoesOn) {
  ImuCsvReader sut(write("imu.csv",
                         std::string(kHeader) + "100,0,0,0,0,0,9\n"
                                                "\n"
                                                "110,0,0,0,0\n"  // line 4
                                                "120,0,zero,0,0,0,9\n"
                                                "130,0,nan,0,0,0,9\n"
                                                "140,0,0,0,0,inf,9\n"
                                                "1.5e2,0,0,0,0,0,9\n"
                                                "100,0,0,0,0,0,9\n"  // twice
                                                "90,0,0,0,0,0,9\n"   // backwards
                                                "99999999999999999999,0,0,0,0,0,9\n"
                                                "200,0,0,0,0,0,9\n"));

  const auto samples = read_all(sut);

  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[1].stamp.time_since_epoch().count(), 200);
  EXPECT_EQ(refused(sut, RowRefusal::kTooFewColumns), 1U);
  EXPECT_EQ(refused(sut, RowRefusal::kNotANumber), 5U);
  EXPECT_EQ(refused(sut, RowRefusal::kTimeNotIncreasing), 2U);
  EXPECT_EQ(sut.counters().first_refused_line, 4U);
}

TEST_F(CsvReaderTest, NamesTheMissingColumn) {
  const auto file =
      write("imu.csv", "timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2\n1,2,3\n");

  const std::string message = message_of<RecordingError>([&] { ImuCsvReader reader(file); });

  EXPECT_NE(message.find("imu.csv: line 1"), std::string::npos) << message;
  EXPECT_NE(message.find("az_m_s2"), std::string::npos) << message;
}

TEST_F(CsvReaderTest, SaysWhichFileCannotBeRead) {
  const std::string absent =
      message_of<RecordingError>([&] { ImuCsvReader reader(folder_ / "absent.csv"); });
  const auto empty_file = write("empty.csv", "");
  const std::string empty = message_of<RecordingError>([&] { ImuCsvReader reader(empty_file); });

  EXPECT_NE(absent.find("absent.csv"), std::string::npos) << absent;
  EXPECT_NE(empty.find("empty.csv"), std::string::npos) << empty;
}

TEST_F(CsvReaderTest, ReadsFixesAndTakesUnknownKindsAndPlacesForNone) {
  GnssCsvReader sut(write("gnss.csv", "timestamp_ns,quality,lat_deg,lon_deg,alt_m,sats,hdop,speed_m_s,course_deg\n"
                                      "1,4,52.4,-13.5,34.5,11,0.9,1.5,271.0\n"
                                      "2,8,52.4,13.5,34.5,11,0.9,1.5,271.0\n"
                                      "3,1,52.4,213.5,34.5,300,0.9,1.5,271.0\n"));
  sensor::GnssFix fix;

  ASSERT_TRUE(sut.next(fix));
  EXPECT_EQ(fix.stamp.time_since_epoch().count(), 1);
  EXPECT_EQ(fix.quality, sensor::FixQuality::kRtkFixed);
  EXPECT_EQ(fix.latitude_deg, 52.4);
  EXPECT_EQ(fix.longitude_deg, -13.5);
  EXPECT_EQ(fix.altitude_m, 34.5);
  EXPECT_EQ(fix.satellites, 11);
  EXPECT_EQ(fix.hdop, 0.9);
  EXPECT_EQ(fix.speed_mps, 1.5);
  EXPECT_EQ(fix.course_deg, 271.0);
  ASSERT_TRUE(sut.next(fix));
  EXPECT_FALSE(fix.is_good());
  ASSERT_TRUE(sut.next(fix));
  EXPECT_FALSE(fix.is_good());
  EXPECT_EQ(fix.satellites, 255);
  EXPECT_FALSE(sut.next(fix));
}

}  // namespace
}  // namespace slamd::recording
