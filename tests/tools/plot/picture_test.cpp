#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/plot/png.hpp"
#include "tools/plot/point_picture.hpp"

namespace slamd::plot {
namespace {

std::string base64_of(const std::string& text) {
  return base64(std::as_bytes(std::span(text)));
}

/// Reads a PNG back, as RGB, through libpng's simple interface.
std::vector<std::uint8_t> read_back(const std::vector<std::byte>& png,
                                    std::size_t& width,
                                    std::size_t& height) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  std::vector<std::uint8_t> rgb;
  if (png_image_begin_read_from_memory(&image, png.data(), png.size()) != 0) {
    image.format = PNG_FORMAT_RGB;
    rgb.resize(PNG_IMAGE_SIZE(image));
    png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr);
  }
  width = image.width;
  height = image.height;
  return rgb;
}

TEST(Base64, MatchesTheExamplesOfRfc4648) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64_of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
}

TEST(Png, ReadsBackAsItWasWritten) {
  const IndexedImage image{3, 2, {{0, 0, 0}, {255, 0, 10}, {1, 2, 3}}, {0, 1, 2, 2, 1, 0}};

  std::size_t width = 0;
  std::size_t height = 0;
  const auto rgb = read_back(png_of(image), width, height);

  EXPECT_EQ(width, 3U);
  EXPECT_EQ(height, 2U);
  EXPECT_EQ(
      rgb, (std::vector<std::uint8_t>{0, 0, 0, 255, 0, 10, 1, 2, 3, 1, 2, 3, 255, 0, 10, 0, 0, 0}));
}

TEST(Png, RefusesAnEmptyPicture) {
  EXPECT_THROW(png_of(IndexedImage{}), std::runtime_error);
}

TEST(Png, RefusesAPictureWithoutWidth) {
  const IndexedImage image{0, 2, {{0, 0, 0}}, {}};

  EXPECT_THROW(png_of(image), std::runtime_error);
}

TEST(HeightColour, GrowsLighter) {
  int last = 0;
  for (double share = 0.0; share <= 1.0; share += 0.125) {
    const Rgb colour = height_colour(share);
    const int light = 2126 * colour.r + 7152 * colour.g + 722 * colour.b;
    EXPECT_GT(light, last) << share;
    last = light;
  }
  EXPECT_EQ(hex(height_colour(2.0)), hex(height_colour(1.0)));
}

TEST(PointPicture, ShowsAPointWhereItIs) {
  const std::vector<Eigen::Vector3f> points = {{2.5F, 7.5F, 0.0F}};
  const Window window{{0.0, 10.0}, {0.0, 10.0}};

  const PointPicture sut = picture_of(points, {}, window, 100);

  ASSERT_EQ(sut.image.height, 100U);
  EXPECT_NE(sut.image.pixels[25 * 100 + 25], 0);  // a quarter from the left, a quarter from the top
  EXPECT_EQ(sut.image.pixels[75 * 100 + 25], 0);
}

TEST(PointPicture, StretchesWhatIsFlat) {
  const std::vector<Eigen::Vector3f> points = {{5.0F, 0.0F, 1.0F}};
  Camera camera;
  camera.up = Eigen::Vector3f::UnitZ();
  camera.stretch = 5.0;

  EXPECT_EQ(picture_of(points, camera, {{0.0, 10.0}, {0.0, 1.5}}, 100).image.height, 75U);
}

TEST(PointPicture, ColoursByTheHighestPoint) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 100; ++i) {
    points.push_back({5.0F, 5.0F, 0.0F});
    points.push_back({1.0F, 1.0F, 0.0F});
  }
  points.push_back({5.0F, 5.0F, 10.0F});
  points.insert(points.end(), 50, {9.0F, 9.0F, 10.0F});

  const PointPicture sut = picture_of(points, {}, {{0.0, 10.0}, {0.0, 10.0}}, 50);

  const auto colour = [&](std::size_t x, std::size_t y) {
    return sut.image.pixels[(50 - y * 5) * 50 + x * 5];
  };
  EXPECT_GT(colour(5, 5), colour(1, 1));
}

TEST(PointPicture, LeavesOutPointsThatAreNoNumbers) {
  const float nan = std::nanf("");
  const std::vector<Eigen::Vector3f> points = {{nan, 1.0F, 1.0F}, {1.0F, 1.0F, 1.0F}};

  const PointPicture sut = picture_of(points, {}, {{0.0, 2.0}, {0.0, 2.0}}, 10);

  EXPECT_EQ(sut.image.pixels.size(), 100U);
}

TEST(WindowOf, LeavesStraysOutButKeepsThePath) {
  std::vector<Eigen::Vector3f> points(10'000, {1.0F, 1.0F, 0.0F});
  points.push_back({5000.0F, 0.0F, 0.0F});
  const std::vector<Eigen::Vector3f> path = {{0.0F, 0.0F, 0.0F}, {20.0F, 0.0F, 0.0F}};

  const Window sut = window_of(points, path, {});

  EXPECT_LT(sut.across.high, 25.0);
  EXPECT_GT(sut.across.high, 20.0);
  EXPECT_LT(sut.across.low, 0.0);
}

TEST(WindowOf, NeedsSomethingToShow) {
  EXPECT_THROW(window_of({}, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace slamd::plot
