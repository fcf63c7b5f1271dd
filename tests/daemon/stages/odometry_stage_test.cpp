#include "daemon/stages/odometry_stage.hpp"

#include <gtest/gtest.h>

#include "tests/support/allocation_guard.hpp"

namespace slamd::stages {
namespace {

constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};
constexpr Duration kScan = std::chrono::milliseconds(100);

odometry::OdometryConfig small_config() {
  odometry::OdometryConfig config;
  config.use_imu = false;
  config.preprocess.max_points = 100;
  return config;
}

/// A scan without points, five samples of wheels that stand still before its end.
void fill(PreprocessedScan& scan, std::uint64_t sequence) {
  scan.sequence = sequence;
  scan.deskewed.end = kBegin + static_cast<int>(sequence) * kScan;
  scan.wheels.clear();
  for (int i = 4; i >= 0; --i) {
    scan.wheels.push_back({scan.deskewed.end - i * std::chrono::milliseconds(20), 0.0, 0.0});
  }
  scan.start_without_imu.reset();
}

TEST(OdometryStage, KeepsTheWheelsOfScansThatItLetsPass) {
  OdometryStage sut(small_config());
  PreprocessedScan scan(small_config());
  fill(scan, 1);
  scan.start_without_imu = kBegin;

  sut.process(scan);
  const auto seen = [&] { return sut.odometry().wheels().counts().used + sut.odometry().wheels().counts().slipped; };
  const std::uint64_t before = seen();
  fill(scan, 2);
  sut.skip(scan);
  fill(scan, 3);
  sut.process(scan);

  EXPECT_EQ(seen(), before + 10);
}

TEST(OdometryStage, DoesNotAllocateWhileScansPass) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  OdometryStage sut(small_config());
  PreprocessedScan scan(small_config());
  fill(scan, 1);
  scan.start_without_imu = kBegin;
  sut.process(scan);

  const auto allocations = support::count_allocations([&] {
    for (std::uint64_t i = 2; i < 400; ++i) {  // more wheels than are kept
      fill(scan, i);
      sut.skip(scan);
    }
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::stages
