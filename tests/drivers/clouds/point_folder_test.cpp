#include "drivers/clouds/point_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "drivers/recording/packet.hpp"
#include "written_cloud.hpp"

namespace slamd::clouds {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

class PointFolderTest : public testing::Test {
 protected:
  PointFolderTest() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / ("slamd_point_folder_" + std::string(test->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  ~PointFolderTest() override { fs::remove_all(folder_); }

  void write(const std::string& name, std::span<const std::byte> bytes) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }

  void write(const std::string& name, std::string_view text) { write(name, Written(text).bytes()); }

  // One point at x.
  void write_bin(const std::string& name, float x_m) {
    write(name, Written().add_le(x_m).add_le(0.0F).add_le(0.0F).add_le(0.5F).bytes());
  }

  void write_timed(const std::string& name,
                   const std::string& type,
                   const char* first,
                   const char* last) {
    write(name,
          "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
          "property float z\nproperty " +
              type + " time\nproperty uchar ring\nend_header\n1 2 3 " + first + " 1\n1 2 4 " +
              last + " 2\n");
  }

  fs::path folder_;
  sensor::Scan scan_{1000};
};

TEST_F(PointFolderTest, CountsNumbersInNamesAsNumbers) {
  write_bin("10.bin", 10.0F);
  write_bin("2.bin", 2.0F);
  write_bin("1.bin", 1.0F);
  PointFolderReader sut(folder_, {});

  std::vector<float> order;
  while (sut.next(scan_)) {
    ASSERT_EQ(scan_.points.size(), 1U);
    EXPECT_EQ(scan_.index, order.size());
    order.push_back(scan_.points[0].x_m);
  }

  EXPECT_EQ(order, (std::vector<float>{1.0F, 2.0F, 10.0F}));
  EXPECT_EQ(sut.counters().scans, 3U);
  EXPECT_EQ(sut.files_read(), 3U);
}

TEST_F(PointFolderTest, StampsTheEndOfCompensatedScansFromTheTimesFile) {
  write_bin("velodyne/000000.bin", 1.0F);
  write_bin("velodyne/000001.bin", 1.0F);
  write_bin("velodyne/000002.bin", 1.0F);
  write("times.txt", "0.0\n1.036224e-01\n5.000000001\n");
  PointFolderReader sut(folder_, {});

  ASSERT_TRUE(sut.next(scan_));
  EXPECT_EQ(scan_.end.time_since_epoch().count(), 0);
  EXPECT_EQ(scan_.end - scan_.begin, milliseconds(100));
  EXPECT_FALSE(scan_.points_have_time);
  EXPECT_TRUE(scan_.complete);
  ASSERT_TRUE(sut.next(scan_));
  EXPECT_EQ(scan_.end.time_since_epoch().count(), 103'622'400);
  EXPECT_EQ(scan_.end - scan_.begin, milliseconds(100));
  ASSERT_TRUE(sut.next(scan_));
  EXPECT_EQ(scan_.end.time_since_epoch().count(), 5'000'000'001);
  EXPECT_EQ(sut.stamp_source(), StampSource::kTimesFile);
}

TEST_F(PointFolderTest, ReadsTheDatesOfKittiRaw) {
  write_bin("velodyne_points/data/0000000000.bin", 1.0F);
  write("velodyne_points/timestamps.txt", "2011-09-26 13:02:25.964389445\n");
  PointFolderReader sut(folder_, {});

  ASSERT_TRUE(sut.next(scan_));

  EXPECT_EQ(scan_.end.time_since_epoch().count(), 1'317'042'145'964'389'445);
}

TEST_F(PointFolderTest, TakesStampsFromMulranNames) {
  write_bin("1567496784952532897.bin", 2.0F);
  write_bin("1567496784852532897.bin", 1.0F);
  PointFolderReader sut(folder_, {});

  ASSERT_TRUE(sut.next(scan_));

  EXPECT_EQ(scan_.end.time_since_epoch().count(), 1'567'496'784'852'532'897);
  EXPECT_EQ(scan_.points[0].x_m, 1.0F);
  EXPECT_EQ(sut.stamp_source(), StampSource::kFileNames);
}

TEST_F(PointFolderTest, CountsAtAFixedRateWhereNothingTells) {
  write_bin("a0.bin", 1.0F);
  write_bin("a1.bin", 1.0F);
  PointFolderReader sut(folder_, {.scans_per_second = 20.0});

  ASSERT_TRUE(sut.next(scan_));
  EXPECT_EQ(scan_.begin, Stamp{});
  ASSERT_TRUE(sut.next(scan_));
  EXPECT_EQ(scan_.begin, Stamp{milliseconds{50}});
  EXPECT_EQ(scan_.end, Stamp{milliseconds{100}});
  EXPECT_EQ(sut.stamp_source(), StampSource::kRate);
}

TEST_F(PointFolderTest, BeginsATimedScanAtItsFirstPoint) {
  write_timed("0.ply", "float", "-0.1", "0");
  write("times.txt", "1000.5\n");
  PointFolderReader sut(folder_, {});

  ASSERT_TRUE(sut.next(scan_));

  EXPECT_TRUE(scan_.points_have_time);
  EXPECT_NEAR(to_seconds(scan_.begin.time_since_epoch()), 1000.4, 1e-7);
  EXPECT_NEAR(to_seconds(scan_.end.time_since_epoch()), 1000.5, 1e-7);
  EXPECT_GT(scan_.end, scan_.begin + Duration{scan_.points.back().offset_ns});
  EXPECT_EQ(scan_.points[1].line, 2);
}

TEST_F(PointFolderTest, PrefersThePointsOwnDates) {
  write_timed("0.ply", "uint64", "1700000000000000007", "1700000000099000000");
  write("times.txt", "12.0\n");
  PointFolderReader sut(folder_, {});

  ASSERT_TRUE(sut.next(scan_));

  EXPECT_EQ(scan_.begin.time_since_epoch().count(), 1'700'000'000'000'000'007);
  EXPECT_EQ(sut.stamp_source(), StampSource::kPointTimes);
}

TEST_F(PointFolderTest, PassesOverFilesItCannotUseAndNamesTheFirst) {
  write_bin("0.bin", 1.0F);
  write("1.bin", "17 bytes, not 16.");
  write_bin("2.bin", 3.0F);
  write_bin("3.bin", 4.0F);
  write_bin("4.bin", 5.0F);
  write("times.txt", "1\n2\n3\n3\n");
  PointFolderReader sut(folder_, {});

  std::uint64_t scans = 0;
  while (sut.next(scan_)) {
    EXPECT_EQ(scan_.index, scans++);
  }

  EXPECT_EQ(scans, 2U);
  EXPECT_EQ(sut.counters().refused_for(CloudRefusal::kTruncated), 1U);
  EXPECT_EQ(sut.counters().refused_for(CloudRefusal::kStampNotIncreasing), 1U);
  EXPECT_EQ(sut.counters().refused_for(CloudRefusal::kNoStamp), 1U);
  EXPECT_EQ(sut.counters().first_refused, "1.bin: truncated");
}

TEST_F(PointFolderTest, CountsPointsBeyondTheScansCapacity) {
  Written points;
  for (int i = 0; i < 5; ++i) {
    points.add_le(1.0F).add_le(static_cast<float>(i)).add_le(0.0F).add_le(0.0F);
  }
  write("0.bin", points.bytes());
  PointFolderReader sut(folder_, {});
  sensor::Scan small(3);

  ASSERT_TRUE(sut.next(small));

  EXPECT_EQ(small.points.size(), 3U);
  EXPECT_EQ(small.points_dropped, 2U);
  EXPECT_EQ(sut.counters().over_capacity, 2U);
}

TEST_F(PointFolderTest, SaysWhatIsWrongWithAFolder) {
  const auto cause = [](const fs::path& folder) -> std::string {
    try {
      PointFolderReader(folder, {});
    } catch (const recording::RecordingError& error) {
      return error.what();
    }
    return "";
  };

  EXPECT_NE(cause(folder_ / "absent").find("is no folder of clouds"), std::string::npos);
  EXPECT_NE(cause(folder_).find("holds no clouds"), std::string::npos);
  write_bin("0.bin", 1.0F);
  write("times.txt", "1.0\nsoon\n");
  EXPECT_NE(cause(folder_).find("times.txt: line 2 is no time"), std::string::npos);
}

}  // namespace
}  // namespace slamd::clouds
