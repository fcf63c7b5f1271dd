#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "drivers/clouds/point_folder.hpp"

namespace slamd::clouds {
namespace {

namespace fs = std::filesystem;

class SharedData : public testing::Test {
 protected:
  static fs::path folder(const char* name) { return fs::path(SLAMD_SHARED_DATA_DIR) / name; }

  sensor::Scan scan_{131'072};
};

#define SKIP_UNLESS_THERE(path)                \
  if (!fs::exists(path)) {                     \
    GTEST_SKIP() << (path) << " is not there"; \
  }

std::size_t lines_of(const sensor::Scan& scan) {
  std::set<int> lines;
  for (const sensor::Point& point : scan.points) {
    lines.insert(point.line);
  }
  return lines.size();
}

TEST_F(SharedData, KittiScansHaveTheLinesOfTheirSensor) {
  SKIP_UNLESS_THERE(folder("kitti00_pairs"));
  PointFolderReader sut(folder("kitti00_pairs"), {});

  while (sut.next(scan_)) {
    EXPECT_EQ(sut.line_source(), LineSource::kFiringOrder);
    EXPECT_EQ(lines_of(scan_), 64U);
    EXPECT_GT(scan_.points.size(), 100'000U);
  }

  EXPECT_EQ(sut.counters().scans, 4U);
}

TEST_F(SharedData, ThinnedKittiScansHaveSixteenLines) {
  SKIP_UNLESS_THERE(folder("kitti_raw_0005_r16"));
  PointFolderReader sut(folder("kitti_raw_0005_r16"), {});

  while (sut.next(scan_)) {
    EXPECT_EQ(sut.line_source(), LineSource::kFiringOrder);
    EXPECT_EQ(lines_of(scan_), 16U) << scan_.index;
    EXPECT_EQ(scan_.end.time_since_epoch(), std::chrono::milliseconds{100} * scan_.index);
  }

  EXPECT_EQ(sut.counters().scans, 73U);
  EXPECT_EQ(sut.counters().empty, 0U);
  EXPECT_EQ(sut.stamp_source(), StampSource::kTimesFile);
}

TEST_F(SharedData, AviaFramesKeepTagAndLine) {
  SKIP_UNLESS_THERE(folder("livox_avia_pcd10"));
  PointFolderReader sut(folder("livox_avia_pcd10"), {});

  std::uint64_t firings = 0;
  while (sut.next(scan_)) {
    EXPECT_EQ(sut.line_source(), LineSource::kField);
    EXPECT_EQ(lines_of(scan_), 6U);
    EXPECT_TRUE(std::all_of(scan_.points.begin(), scan_.points.end(), [](const sensor::Point& p) {
      return p.tag == 0x10;
    }));
  }
  firings = sut.counters().points + sut.counters().empty;

  EXPECT_EQ(sut.counters().scans, 10U);
  EXPECT_EQ(firings, 240'000U);
}

TEST_F(SharedData, AviaKeyFramesHaveTheirStamps) {
  SKIP_UNLESS_THERE(folder("avia_hku1"));
  PointFolderReader sut(folder("avia_hku1"), {});

  ASSERT_TRUE(sut.next(scan_));
  EXPECT_EQ(scan_.end.time_since_epoch().count(), 1'577'836'980'099'104'600);
  while (sut.next(scan_)) {
  }

  EXPECT_EQ(sut.counters().scans, 314U);
  EXPECT_EQ(sut.line_source(), LineSource::kElevation);
}

}  // namespace
}  // namespace slamd::clouds
