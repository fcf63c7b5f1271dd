#include "core/loop/polar_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace slamd::loop {
namespace {

geometry::Se3 turned(double yaw_rad) {
  return {Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix(), Eigen::Vector3d::Zero()};
}

PolarImage image_of(const std::vector<Eigen::Vector3f>& points, const geometry::Se3& T_level_points = {}) {
  PolarImager sut;
  sut.add(T_level_points, points);
  PolarImage image;
  sut.finish(image);
  return image;
}

std::size_t occupied(const PolarImage& image) {
  return static_cast<std::size_t>(
      std::count_if(image.cells.begin(), image.cells.end(), [](std::uint8_t cell) { return cell > 0; }));
}

TEST(PolarImager, PutsAPointIntoItsSliceRingAndAzimuth) {
  // Rings: ln(10 / 0.8) / ln(75) · 40 = 23.4; azimuth of 91.5°: 30.5.
  const double azimuth_rad = 91.5 * M_PI / 180.0;
  const PolarImage image =
      image_of({{static_cast<float>(10.0 * std::cos(azimuth_rad)), static_cast<float>(10.0 * std::sin(azimuth_rad)), 1.0F}});

  EXPECT_EQ(image.cells[PolarImage::index(4, 23, 30)], 32);
  EXPECT_EQ(occupied(image), 1U);
}

TEST(PolarImager, CountsByTheLogarithmAndStopsAt255) {
  EXPECT_EQ(image_of(std::vector<Eigen::Vector3f>(3, {5.0F, 0.1F, 0.3F})).cells[PolarImage::index(3, 16, 0)], 64);
  EXPECT_EQ(image_of(std::vector<Eigen::Vector3f>(100'000, {5.0F, 0.1F, 0.3F})).cells[PolarImage::index(3, 16, 0)], 255);
}

TEST(PolarImager, LeavesOutWhatIsTooNearTooFarOrNoNumber) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const PolarImage image = image_of({{0.5F, 0.5F, 0.0F}, {60.0F, 1.0F, 0.0F}, {nan, 1.0F, 0.0F}, {5.0F, 5.0F, nan},
                                     {5.0F, infinity, 0.0F}, {5.0F, 5.0F, -infinity}});

  EXPECT_EQ(occupied(image), 0U);
}

TEST(PolarImager, ShiftsAzimuthsWhenTheHeadingTurns) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 400; ++i) {
    const double azimuth_rad = (0.31 + 0.9 * i) * M_PI / 180.0;
    const double range_m = 2.0 + 0.1 * i;
    points.emplace_back(range_m * std::cos(azimuth_rad), range_m * std::sin(azimuth_rad), 0.01 * i - 1.0);
  }

  const PolarImage image = image_of(points);
  const PolarImage turned_image = image_of(points, turned(30.0 * M_PI / 180.0));  // ten azimuths

  for (std::size_t row = 0; row < PolarImage::kSlices * PolarImage::kRings; ++row) {
    for (std::size_t azimuth = 0; azimuth < PolarImage::kAzimuths; ++azimuth) {
      ASSERT_EQ(image.cells[row * PolarImage::kAzimuths + azimuth],
                turned_image.cells[row * PolarImage::kAzimuths + (azimuth + 10) % PolarImage::kAzimuths]);
    }
  }
}

TEST(PolarImager, ForgetsWhenItIsCleared) {
  PolarImager sut;
  sut.add({}, std::vector<Eigen::Vector3f>{{5.0F, 5.0F, 0.0F}});
  sut.clear();
  PolarImage image;
  sut.finish(image);

  EXPECT_EQ(occupied(image), 0U);
}

TEST(PolarImager, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  PolarImager sut;
  PolarImage image;
  const std::vector<Eigen::Vector3f> points(1000, {5.0F, 5.0F, 0.0F});

  EXPECT_EQ(support::count_allocations([&] {
              sut.clear();
              sut.add({}, points);
              sut.finish(image);
            }),
            0U);
}

TEST(LevelOf, KeepsPositionAndHeadingAndStandsUpright) {
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) *
                             Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();

  const geometry::Se3 T_odom_level = level_of({R, {1.0, 2.0, 3.0}});

  EXPECT_LT((T_odom_level.rotation() - turned(2.5).rotation()).norm(), 1e-12);
  EXPECT_EQ(T_odom_level.translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
}

}  // namespace
}  // namespace slamd::loop
