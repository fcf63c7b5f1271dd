#include "daemon/bus/scan_chunks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>


namespace slamd::bus {
namespace {

const geometry::Se3 kT_odom_base(Eigen::Quaterniond(0.8, 0.0, 0.0, 0.6), Eigen::Vector3d(1234.567, -89.012, 3.4));
const geometry::Se3 kT_base_imu(Eigen::Quaterniond(0.6, 0.8, 0.0, 0.0), Eigen::Vector3d(0.1, 0.2, 0.3));

std::vector<Eigen::Vector3f> made_points(std::size_t count) {
  std::vector<Eigen::Vector3f> points;
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> within(-60.0F, 60.0F);
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(within(engine), within(engine), within(engine));
  }
  return points;
}

Scan made_scan(std::uint64_t index, std::span<const Eigen::Vector3f> points) {
  return {.scan_index = index,
          .stamp = Stamp(std::chrono::milliseconds(100 * index)),
          .T_odom_base = kT_odom_base,
          .T_odom_imu = kT_odom_base * kT_base_imu,
          .points_imu = points};
}

std::vector<ScanChunk> chunks_of(ScanChunker& chunker, const Scan& scan) {
  std::vector<ScanChunk> chunks;
  const std::size_t count = chunker.begin(scan);
  for (std::size_t i = 0; i < count; ++i) {
    chunks.push_back(chunker.chunk(i));
  }
  return chunks;
}

TEST(ScanChunker, CutsTheExampleOfTheProtocolAsItIsWritten) {
  std::vector<Eigen::Vector3f> points(201, Eigen::Vector3f(1.0F, -2.0F, 3.0F));
  points[200] = {0.5F, 0.0F, -0.25F};
  Scan scan;
  scan.points_imu = points;
  ScanChunker sut(2000);

  const auto chunks = chunks_of(sut, scan);

  ASSERT_EQ(chunks.size(), 2U);
  EXPECT_EQ(chunks[0].points_cm.size(), 200U);
  EXPECT_EQ(chunks[0].points_cm[0], (ScanChunk::Point{100, -200, 300}));
  ASSERT_EQ(chunks[1].points_cm.size(), 1U);
  EXPECT_EQ(chunks[1].points_cm[0], (ScanChunk::Point{50, 0, -25}));
  EXPECT_EQ(chunks[1].scan_crc32, 0x9CE49564U);  // as zlib's crc32 gives it for the 1,206 bytes
}

TEST(ScanAssembly, GivesTheScanBackToHalfACentimetre) {
  const auto points = made_points(1001);
  ScanChunker chunker(2000);
  ScanAssembly sut;
  std::optional<AssembledScan> scan;

  for (const ScanChunk& chunk : chunks_of(chunker, made_scan(1, points))) {
    ASSERT_FALSE(scan);
    scan = sut.add(chunk);
  }

  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->scan_index, 1U);
  EXPECT_EQ(scan->T_odom_base.translation(), kT_odom_base.translation());
  ASSERT_EQ(scan->points_odom.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p_odom = kT_odom_base * (kT_base_imu * points[i].cast<double>());
    EXPECT_LE((scan->points_odom[i] - p_odom).cwiseAbs().maxCoeff(), 0.005 + 1e-9);
  }
}

TEST(ScanAssembly, TakesChunksInAnyOrder) {
  const auto points = made_points(1000);
  ScanChunker chunker(2000);
  auto chunks = chunks_of(chunker, made_scan(1, points));
  std::reverse(chunks.begin(), chunks.end());
  ScanAssembly sut;

  std::optional<AssembledScan> scan;
  for (const ScanChunk& chunk : chunks) {
    scan = sut.add(chunk);
  }

  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->points_odom.size(), 1000U);
}

TEST(ScanAssembly, CountsAScanThatANewerOneEnds) {
  const auto points = made_points(1000);
  ScanChunker chunker(2000);
  const auto first = chunks_of(chunker, made_scan(1, points));
  const auto second = chunks_of(chunker, made_scan(2, points));
  ScanAssembly sut;

  for (std::size_t i = 1; i < first.size(); ++i) {
    EXPECT_FALSE(sut.add(first[i]));
  }
  EXPECT_FALSE(sut.add(second[0]));
  EXPECT_FALSE(sut.add(first[0]));

  EXPECT_EQ(sut.incomplete(), 1U);
  EXPECT_EQ(sut.late(), 1U);
}

TEST(ScanAssembly, CountsAChunkThatComesTwice) {
  const auto points = made_points(300);
  ScanChunker chunker(2000);
  const auto chunks = chunks_of(chunker, made_scan(1, points));
  ScanAssembly sut;

  EXPECT_FALSE(sut.add(chunks[0]));
  EXPECT_FALSE(sut.add(chunks[0]));

  EXPECT_EQ(sut.late(), 1U);
  EXPECT_TRUE(sut.add(chunks[1]));
}

TEST(ScanAssembly, RefusesAScanWhoseCrcIsWrong) {
  const auto points = made_points(300);
  ScanChunker chunker(2000);
  auto chunks = chunks_of(chunker, made_scan(1, points));
  chunks[1].points_cm[7][2] ^= 1;
  ScanAssembly sut;

  EXPECT_FALSE(sut.add(chunks[0]));
  EXPECT_FALSE(sut.add(chunks[1]));

  EXPECT_EQ(sut.corrupt(), 1U);
}

TEST(ScanChunker, SendsNoMorePointsThanAllowed) {
  for (const std::size_t count : {1999UL, 2000UL, 2001UL, 30000UL}) {
    const auto points = made_points(count);
    ScanChunker sut(2000);

    std::size_t sent = 0;
    for (const ScanChunk& chunk : chunks_of(sut, made_scan(1, points))) {
      sent += chunk.points_cm.size();
    }

    EXPECT_LE(sent, 2000U);
    EXPECT_GT(sent, 1000U);
  }
}

TEST(ScanChunker, LeavesOutWhatIsTooFarOrNoPlace) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points{{1.0F, 2.0F, 3.0F}, {500.0F, 0.0F, 0.0F}, {nan, 0.0F, 0.0F}};
  ScanChunker sut(2000);

  const auto chunks = chunks_of(sut, made_scan(1, points));

  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_EQ(chunks[0].points_cm.size(), 1U);
}

TEST(ScanChunker, SendsAnEmptyScanAsOneChunkWithoutPoints) {
  ScanChunker sut(2000);
  ScanAssembly assembly;

  const auto chunks = chunks_of(sut, made_scan(1, {}));

  ASSERT_EQ(chunks.size(), 1U);
  const auto scan = assembly.add(chunks[0]);
  ASSERT_TRUE(scan);
  EXPECT_TRUE(scan->points_odom.empty());
}

TEST(ScanChunker, SendsNothingWhenSwitchedOff) {
  const auto points = made_points(10);
  ScanChunker sut(0);

  EXPECT_EQ(sut.begin(made_scan(1, points)), 0U);
}

}  // namespace
}  // namespace slamd::bus
