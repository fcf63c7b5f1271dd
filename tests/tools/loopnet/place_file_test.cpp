#include "tools/loopnet/place_file.hpp"

#include <cstring>
#include <memory>

#include "tests/scratch/scratch_folder.hpp"
#include "tools/loopnet/recorded_places.hpp"

namespace slamd::loopnet {
namespace {

class PlaceFileTest : public scratch::ScratchFolder {
 protected:
  static float number(const std::string& text, std::size_t at) {
    float value = 0.0F;
    std::memcpy(&value, text.data() + at, sizeof(value));
    return value;
  }
};

TEST_F(PlaceFileTest, WritesWhatNumPyReads) {
  PlaceFile sut(folder_);
  loop::PolarImage image;
  image.cells[7] = 32;

  sut.add({.world = 1, .place = 2, .yaw_rad = 0.5F}, image, {});
  sut.add({.world = 1, .place = 3}, image, {});
  sut.close();

  const std::string images = text_of(folder_ / "images.npy");
  EXPECT_EQ(images.size(), 128 + 2 * loop::PolarImage::kCells);
  EXPECT_EQ(images.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_NE(images.find("'descr': '|u1', 'fortran_order': False, 'shape': (2, 8, 40, 120)"), std::string::npos);
  EXPECT_EQ(images[127], '\n');
  EXPECT_EQ(images[128 + 7], 32);
  const std::string visits = text_of(folder_ / "visits.npy");
  EXPECT_EQ(visits.size(), 128U + 2 * 36U);
  EXPECT_EQ(number(visits, 128 + 32), 0.5F);
  EXPECT_EQ(text_of(folder_ / "contexts.npy").size(), 128U + 2 * 4800U);
}

TEST_F(PlaceFileTest, TakesCloudsByTheNumberInTheirNames) {
  // Three clouds of one point each, 10 m ahead; the second pose looks to the left.
  const float point[4] = {10.0F, 0.01F, 0.3F, 0.0F};
  const std::string cloud(reinterpret_cast<const char*>(point), sizeof(point));
  write("clouds/000001.bin", cloud);
  write("clouds/000002.bin", cloud);
  write("poses.txt", "1 0 0 9 0 1 0 9 0 0 1 9\n1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 5 1 0 0 0 0 0 1 0\n");
  auto file = std::make_unique<PlaceFile>(folder_ / "out");

  EXPECT_EQ(add_recorded_places({.clouds = folder_ / "clouds", .poses = folder_ / "poses.txt", .turn = false}, *file), 2U);
  file->close();

  const std::string visits = text_of(folder_ / "out" / "visits.npy");
  EXPECT_EQ(number(visits, 128 + 36 + 20), 5.0F);
  EXPECT_NEAR(number(visits, 128 + 36 + 32), M_PI_2, 1e-6);
  const std::string images = text_of(folder_ / "out" / "images.npy");
  EXPECT_EQ(images[128 + loop::PolarImage::index(3, 23, 0)], 32);
}

TEST_F(PlaceFileTest, RefusesACloudWithoutAPose) {
  write("clouds/000003.bin", std::string(16, '\0'));
  write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  PlaceFile file(folder_ / "out");

  EXPECT_ANY_THROW(add_recorded_places({.clouds = folder_ / "clouds", .poses = folder_ / "poses.txt"}, file));
}

}  // namespace
}  // namespace slamd::loopnet
