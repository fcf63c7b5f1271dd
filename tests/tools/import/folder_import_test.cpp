#include "tools/import/folder_import.hpp"

#include <gtest/gtest.h>

#include "drivers/recording/csv_reader.hpp"
#include "drivers/recording/packet.hpp"
#include "drivers/recording/tum.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/cli/cli.hpp"
#include "tools/import/recording_writer.hpp"

namespace slamd::importing {
namespace {

namespace fs = std::filesystem;

const auto kQuiet = [](double) {
};

class FolderImport : public scratch::ScratchFolder {
 protected:
  static std::string ply(const std::string& rows, int count, const std::string& time) {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
           "property uchar ring\n" +
           time + "end_header\n" + rows;
  }
};

TEST_F(FolderImport, GivesBackEveryPointAndEveryNanosecond) {
  write("in/0.ply", ply("1 2 3 0.5 7 0\n4 5 6 1 8 99000123\n", 2, "property uint t\n"));
  write("in/1.ply", ply("1 2 3 0.001 7 5\n", 1, "property uint t\n"));
  write("in/times.txt", "1700000000.123456789\n1700000000.323456789\n");

  const Summary summary = import_folder(folder_ / "in", folder_ / "out", {}, kQuiet);

  EXPECT_EQ(summary.scans, 2U);
  EXPECT_EQ(summary.points, 3U);
  clouds::PointFolderReader back(folder_ / "out/lidar", {});
  sensor::Scan scan(10);
  ASSERT_TRUE(back.next(scan));
  EXPECT_TRUE(scan.points_have_time);
  EXPECT_EQ(scan.begin.time_since_epoch().count(), 1'700'000'000'123'456'789);
  ASSERT_EQ(scan.points.size(), 2U);
  EXPECT_EQ(scan.points[1].offset_ns, 99'000'123U);
  EXPECT_EQ(scan.points[1].line, 8);
  EXPECT_EQ(scan.points[0].intensity, 127);
  EXPECT_EQ(scan.points[1].z_m, 6.0F);
  ASSERT_TRUE(back.next(scan));
  EXPECT_EQ(scan.begin.time_since_epoch().count(), 1'700'000'000'323'456'794);
  EXPECT_EQ(scan.points[0].intensity, 0);  // 0.001 of 255: not scaled once more
  const std::string toml = text_of(folder_ / "out/recording.toml");
  EXPECT_NE(toml.find("model = \"points\""), std::string::npos);
  EXPECT_NE(toml.find("points_have_time = true"), std::string::npos);
  EXPECT_EQ(toml.find("[imu]"), std::string::npos);
}

TEST_F(FolderImport, TakesMulransInertialSamplesAndCountsBadRows) {
  write("in/sensor_data/Ouster/1567496784952532897.bin", std::string(16, '\x3F'));
  write("in/sensor_data/xsens_imu.csv",
        "1567496784000000001,0,0,0,1,0,0,0,0.1,0.2,0.3,1,2,9.8,0,0,0\r\n"
        "1567496784010000001,0,0,0,1,0,0,0,0.1,0.2\n"
        "1567496784020000001,0,0,0,1,0,0,0,nan,0.2,0.3,1,2,9.8,0,0,0\n");

  const Summary summary = import_folder(folder_ / "in", folder_ / "out", {}, kQuiet);

  EXPECT_EQ(summary.scans, 1U);
  EXPECT_EQ(summary.imu_samples, 1U);
  EXPECT_EQ(summary.refused.at("malformed_imu_row"), 2U);
  recording::ImuCsvReader imu(folder_ / "out/imu.csv");
  sensor::ImuSample sample;
  ASSERT_TRUE(imu.next(sample));
  EXPECT_EQ(sample.stamp.time_since_epoch().count(), 1'567'496'784'000'000'001);
  EXPECT_EQ(sample.angular_rate_radps, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(sample.specific_force_mps2, Eigen::Vector3d(1.0, 2.0, 9.8));
  EXPECT_NE(text_of(folder_ / "out/recording.toml").find("source = \"imu.csv\""), std::string::npos);
}

TEST_F(FolderImport, GivesKittiRowsTheStampsOfTheScans) {
  write("in/000000.bin", std::string(16, '\x3F'));
  write("in/000001.bin", std::string(16, '\x3F'));
  write("in/times.txt", "0.5\n0.6\n");
  write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 2 0 1 0 3 0 0 1 4\n");
  FolderOptions options;
  options.truth = folder_ / "poses.txt";

  const Summary summary = import_folder(folder_ / "in", folder_ / "out", options, kQuiet);

  EXPECT_EQ(summary.truth_poses, 2U);
  const auto poses = recording::read_tum(folder_ / "out/truth.tum");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[1].stamp.time_since_epoch().count(), 600'000'000);
  EXPECT_EQ(poses[1].T.translation(), Eigen::Vector3d(2.0, 3.0, 4.0));
}

TEST_F(FolderImport, LeavesNoRecordingWhenNothingCanBeRead) {
  write("in/0.bin", "odd");

  EXPECT_THROW(import_folder(folder_ / "in", folder_ / "out", {}, kQuiet),
               recording::RecordingError);

  EXPECT_FALSE(fs::exists(folder_ / "out/recording.toml"));
}

TEST_F(FolderImport, OverwritesOnlyWhenForcedAndOnlyItsOwnFiles) {
  write("out/recording.toml", "old");
  write("out/notes.txt", "mine");
  write("out/lidar/000000.ply", "old");

  EXPECT_THROW(prepare_directory(folder_ / "out", false), cli::UsageError);
  EXPECT_EQ(text_of(folder_ / "out/recording.toml"), "old");
  prepare_directory(folder_ / "out", true);

  EXPECT_FALSE(fs::exists(folder_ / "out/recording.toml"));
  EXPECT_FALSE(fs::exists(folder_ / "out/lidar"));
  EXPECT_EQ(text_of(folder_ / "out/notes.txt"), "mine");
  EXPECT_THROW(prepare_directory(folder_ / "out/notes.txt", true), cli::UsageError);
}

}  // namespace
}  // namespace slamd::importing
