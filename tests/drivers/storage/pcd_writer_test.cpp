#include "drivers/storage/pcd_writer.hpp"

#include <gtest/gtest.h>

#include "tests/drivers/storage/read_back.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::storage {
namespace {

class PcdWriter : public scratch::ScratchFolder {};

TEST_F(PcdWriter, HoldsACloudThatTheReaderOfPcdTakes) {
  const std::vector<Eigen::Vector3f> points{{1.0F, -2.0F, 3.5F}, {0.25F, 0.0F, -7.0F}};

  write_pcd(folder_ / "0.pcd", points);

  const auto read = read_back(folder_ / "0.pcd");
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(read[i], points[i].cast<double>()) << i;
  }
  EXPECT_NE(scratch::message_of<std::runtime_error>([&] { write_pcd(folder_ / "no" / "0.pcd", points); }).find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace slamd::storage
