#include "drivers/recording/tum.hpp"

#include <gtest/gtest.h>

#include "drivers/recording/packet.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::recording {
namespace {

using scratch::message_of;
using scratch::ScratchFolder;

class TumTest : public ScratchFolder {};

TEST_F(TumTest, ReadsBackWhatItWrote) {
  const std::vector<StampedPose> poses = {
      {Stamp{Duration{1'700'000'000'123'456'789}},
       geometry::Se3(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1.0, -2.5, 1e3})},
      {Stamp{Duration{1'700'000'000'123'456'790}}, geometry::Se3()}};
  const auto file = folder_ / "a.tum";
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  for (const StampedPose& pose : poses) {
    write_tum_line(stream, pose.stamp, pose.T);
  }
  std::fclose(stream);

  const auto sut = read_tum(file);

  ASSERT_EQ(sut.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(sut[i].stamp, poses[i].stamp);
    EXPECT_LT((sut[i].T.translation() - poses[i].T.translation()).norm(), 1e-6);
    EXPECT_LT((sut[i].T.rotation() - poses[i].T.rotation()).norm(), 1e-8);
  }
}

TEST_F(TumTest, PassesOverCommentsAndEmptyLines) {
  const auto sut = read_tum(write("a.tum", "# time x y z\n\n  # more\n1.5 1 2 3 0 0 0 2\r\n"));

  ASSERT_EQ(sut.size(), 1U);
  EXPECT_EQ(sut[0].stamp.time_since_epoch().count(), 1'500'000'000);
  EXPECT_LT((sut[0].T.rotation() - Eigen::Matrix3d::Identity()).norm(), 1e-12);  // normalised
}

TEST_F(TumTest, NamesFileAndLineOfWhatIsWrong) {
  for (const char* row : {"1.5 1 2 3 0 0 0",
                          "soon 1 2 3 0 0 0 1",
                          "1.5 1 2 nan 0 0 0 1",
                          "1.5 1 2 3 0 0 0 0",
                          "1.5 1 2 3 0 0 0 one"}) {
    const auto file = write("a.tum", "0.5 1 2 3 0 0 0 1\n" + std::string(row) + "\n");

    const std::string message = message_of<RecordingError>([&] { read_tum(file); });

    EXPECT_NE(message.find("a.tum: line 2"), std::string::npos) << row << ": " << message;
  }
}

TEST_F(TumTest, ReadsKittiRowsWithTheirTimes) {
  const auto rows = write("poses.txt", "1 0 0 1 0 1 0 2 0 0 1 3\n0 -1 0 4 1 0 0 5 0 0 1 6\n");
  const auto times = write("times.txt", "0.0\n1.036224e-01\n");

  const auto sut = read_kitti(rows, times);

  ASSERT_EQ(sut.size(), 2U);
  EXPECT_EQ(sut[1].stamp.time_since_epoch().count(), 103'622'400);
  EXPECT_EQ(sut[1].T.translation(), Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_LT((sut[1].T * Eigen::Vector3d::UnitX() - Eigen::Vector3d(4.0, 6.0, 6.0)).norm(), 1e-12);
}

TEST_F(TumTest, RefusesMoreRowsThanTimes) {
  const auto rows = write("poses.txt", "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 1 0 1 0 2 0 0 1 3\n");
  const auto times = write("times.txt", "0.0\n");

  EXPECT_THROW(read_kitti(rows, times), RecordingError);
}

}  // namespace
}  // namespace slamd::recording
