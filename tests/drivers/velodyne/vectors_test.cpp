// Real packets beside what another decoder makes of them; third-party bytes, read where they lie.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "made_packet.hpp"

namespace slamd::velodyne {
namespace {

using namespace std::chrono_literals;

namespace fs = std::filesystem;

fs::path vector_file(const char* name) { return fs::path(SLAMD_SHARED_DATA_DIR) / "../protocols/vectors" / name; }

#define SKIP_UNLESS_THERE(path)                \
  if (!fs::exists(path)) {                     \
    GTEST_SKIP() << (path) << " is not there"; \
  }

/// One packet a line.
std::vector<std::vector<std::byte>> packets_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::vector<std::byte>> packets;
  for (std::string line; std::getline(stream, line);) {
    std::vector<std::byte> packet;
    for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
      packet.push_back(static_cast<std::byte>(std::stoi(line.substr(i, 2), nullptr, 16)));
    }
    packets.push_back(packet);
  }
  return packets;
}

/// A row of the other decoder's cloud.
struct Expected {
  double x_m, y_m, z_m;
  int intensity;
  int ring;
  double azimuth_deg;
  double time_ns;
};

std::vector<Expected> rows_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  std::vector<Expected> rows;
  while (std::getline(stream, line)) {
    std::istringstream fields(line);
    std::vector<double> values;
    for (std::string field; std::getline(fields, field, ',');) {
      values.push_back(std::stod(field));
    }
    rows.push_back({values.at(0), values.at(1), values.at(2), static_cast<int>(values.at(3)),
                    static_cast<int>(values.at(5)), values.at(6), values.at(9)});
  }
  return rows;
}

TEST(VelodyneVectors, AgreeWithTheOtherDecodersDualCloudPointByPoint) {
  const fs::path packets_file = vector_file("vlp16_dual_real_packets.hex");
  const fs::path cloud_file = vector_file("vlp16_dual_expected_first40.csv");
  SKIP_UNLESS_THERE(packets_file);
  SKIP_UNLESS_THERE(cloud_file);
  const auto packets = packets_of(packets_file);
  const auto expected = rows_of(cloud_file);
  ASSERT_EQ(packets.size(), 4U);
  ASSERT_EQ(expected.size(), 40U);
  Decoder sut{DecoderConfig{}};
  sensor::PointBlock block;

  ASSERT_EQ(sut.decode(packets[0], Stamp{}, block), DecodeResult::kOk);

  EXPECT_EQ(block.device_stamp.time_since_epoch(), 140'854'497us);
  EXPECT_EQ(sut.report().last_return_mode, kDual);
  EXPECT_EQ(block.sequences[0].azimuth_cdeg, 30);
  EXPECT_EQ(block.sequences[10].azimuth_cdeg, 228);
  ASSERT_GE(block.points.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const sensor::Point& point = block.points[i];
    EXPECT_NEAR(point.x_m, expected[i].x_m, 1e-3) << i;
    EXPECT_NEAR(point.y_m, expected[i].y_m, 1e-3) << i;
    EXPECT_NEAR(point.z_m, expected[i].z_m, 1e-3) << i;
    EXPECT_NEAR(direction_of(point).azimuth_deg, expected[i].azimuth_deg, 0.0101) << i;
    EXPECT_EQ(point.intensity, expected[i].intensity) << i;
    EXPECT_EQ(point.line, expected[i].ring) << i;
    // Where there are two returns the other decoder still counts 110.592 µs for each block, twice the truth.
    const double pair = std::floor(expected[i].time_ns / 221'184.0);
    EXPECT_NEAR(point.offset_ns, expected[i].time_ns - 110'592.0 * pair, 150.0) << i;
  }
}

TEST(VelodyneVectors, FollowEachOtherByTheirOwnDuration) {
  const fs::path file = vector_file("vlp16_dual_real_packets.hex");
  SKIP_UNLESS_THERE(file);
  Decoder sut{DecoderConfig{}};
  sensor::PointBlock block;
  DeviceStamp next{};

  for (const auto& packet : packets_of(file)) {
    ASSERT_EQ(sut.decode(packet, Stamp{}, block), DecodeResult::kOk);

    if (next != DeviceStamp{}) {
      EXPECT_NEAR(static_cast<double>((block.device_stamp - next).count()), 0.0, 1'000.0);  // whole microseconds
    }
    next = block.device_stamp + block.duration;
  }
}

TEST(VelodyneVectors, ShowTheFirstFiringsOfARealVlp32c) {
  const fs::path file = vector_file("vlp32c_real_packets.hex");
  SKIP_UNLESS_THERE(file);
  const auto packets = packets_of(file);
  ASSERT_EQ(packets.size(), 2U);
  Decoder sut{DecoderConfig{}};
  sensor::PointBlock block;

  ASSERT_EQ(sut.decode(packets[0], Stamp{}, block), DecodeResult::kOk);

  EXPECT_EQ(block.device_stamp.time_since_epoch(), 625'659'068us);
  EXPECT_EQ(sut.report().last_return_mode, kStrongest);
  EXPECT_EQ(sut.report().last_product, 0x28);
  EXPECT_EQ(block.sequences[0].azimuth_cdeg, 27039);
  EXPECT_NEAR(direction_of(block.points[0]).range_m, 0.756, 1e-6);
  EXPECT_EQ(block.points[0].intensity, 11);
  EXPECT_NEAR(direction_of(block.points[1]).range_m, 2.884, 1e-6);
  EXPECT_EQ(block.points[1].intensity, 8);
  EXPECT_NEAR(direction_of(block.points[5]).range_m, 2.672, 1e-6);
  EXPECT_EQ(block.points[5].intensity, 77);
  EXPECT_EQ(block.points[5].z_m, 0.0F);
}

}  // namespace
}  // namespace slamd::velodyne
