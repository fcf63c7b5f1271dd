#include "core/scan/preprocessor.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/geometry/so3.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/world/room.hpp"

namespace slamd::scan {
namespace {

using geometry::Se3;

const Se3 kSensor(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.5, -0.5, 1.0));

sensor::Scan still_scan(std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  return world::Room().scan(Stamp{}, std::chrono::milliseconds(100), 1800, 0.01, engine, [](double) { return kSensor; });
}

DeskewedScan preprocessed(const PreprocessConfig& config, const sensor::Scan& scan) {
  Preprocessor sut(config);
  ScanMotion motion(config.longest_scan);
  motion.set_still(scan.begin, scan.end);
  DeskewedScan out(config);
  sut.process(scan, motion, Se3(), Se3(), true, out);
  return out;
}

TEST(FeatureClassifier, CallsWallsPlanarAndCornersEdges) {
  const sensor::Scan scan = still_scan(1);
  const std::vector<std::uint8_t> usable(scan.points.size(), 1);
  std::vector<Shape> shapes(scan.points.size());
  FeatureClassifier sut(FeatureConfig{}, scan.points.capacity());

  sut.classify(scan.points.view(), usable, shapes);

  const auto count = [&](Shape shape) { return std::count(shapes.begin(), shapes.end(), shape); };
  EXPECT_GT(count(Shape::kPlanar), static_cast<std::ptrdiff_t>(scan.points.size() / 2));
  EXPECT_GT(count(Shape::kEdge), 20);
  EXPECT_LT(count(Shape::kEdge), static_cast<std::ptrdiff_t>(scan.points.size() / 10));
  // Edges stand at the corners of the pillar at (3.0..3.6, 2.0..2.6).
  int at_pillar = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Eigen::Vector3d p = kSensor * Eigen::Vector3d(scan.points[i].x_m, scan.points[i].y_m, scan.points[i].z_m);
    at_pillar += shapes[i] == Shape::kEdge && p.x() > 2.9 && p.x() < 3.7 && p.y() > 1.9 && p.y() < 2.7 ? 1 : 0;
  }
  EXPECT_GT(at_pillar, 5);
}

TEST(Preprocessor, BoundsAndSpreadsTheFeatures) {
  PreprocessConfig config;
  config.max_planar = 300;
  config.max_edge = 20;
  const DeskewedScan out = preprocessed(config, still_scan(2));

  EXPECT_EQ(out.planar.size(), 300U);
  EXPECT_LE(out.edge.size(), 20U);
  std::set<int> octants;
  for (const FeaturePoint& feature : out.planar) {
    octants.insert(static_cast<int>(std::floor(std::atan2(feature.p_imu.y(), feature.p_imu.x()) * 4.0F / 3.1416F)));
  }
  EXPECT_GE(octants.size(), 8U);
  EXPECT_NEAR(out.median_range_m, 6.0, 3.0);
}

TEST(Preprocessor, TakesRawPointsWhenFeaturesAreFew) {
  PreprocessConfig config;
  config.features.planar_floor_m = 0.0F;
  config.features.planar_slope = 0.0F;

  const DeskewedScan out = preprocessed(config, still_scan(3));

  EXPECT_TRUE(out.raw_features);
  EXPECT_GT(out.planar.size(), 300U);
}

TEST(Preprocessor, LeavesTheRobotsOwnBodyOut) {
  PreprocessConfig config;
  config.self_filter.boxes_base.push_back({{-1.0F, -1.0F, -2.0F}, {12.0F, 12.0F, 5.0F}});

  const DeskewedScan out = preprocessed(config, still_scan(4));

  EXPECT_GT(out.filtered, 1000U);
  for (const FeaturePoint& feature : out.planar) {
    EXPECT_TRUE(feature.p_imu.x() < -1.0F || feature.p_imu.y() < -1.0F);
  }
}

TEST(Preprocessor, HonoursLivoxTags) {
  sensor::Scan scan = still_scan(5);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const std::uint8_t tags[] = {0x10, 0x00, 0x20, 0x14, 0x11, 0x13};  // good, good, 2nd echo, dust, drag, low noise
    scan.points[i].tag = tags[i % 6];
  }

  const DeskewedScan out = preprocessed(PreprocessConfig{}, scan);

  EXPECT_NEAR(static_cast<double>(out.points) / static_cast<double>(scan.points.size()), 0.5, 0.01);
}

TEST(Preprocessor, IgnoresPointsThatAreNotFinite) {
  sensor::Scan scan = still_scan(6);
  scan.points[100].x_m = std::numeric_limits<float>::quiet_NaN();
  scan.points[200].z_m = std::numeric_limits<float>::infinity();

  const DeskewedScan out = preprocessed(PreprocessConfig{}, scan);

  for (const Eigen::Vector3f& p : out.map_points_imu) {
    ASSERT_TRUE(p.allFinite());
  }
  EXPECT_GE(out.filtered, 2U);
}

TEST(Preprocessor, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const PreprocessConfig config{};
  const sensor::Scan scan = still_scan(7);
  Preprocessor sut(config);
  ScanMotion motion(config.longest_scan);
  motion.set_still(scan.begin, scan.end);
  DeskewedScan out(config);

  const std::size_t allocations =
      support::count_allocations([&] { sut.process(scan, motion, Se3(), Se3(), false, out); });

  EXPECT_EQ(allocations, 0U);
  EXPECT_GT(out.planar.size(), 100U);
}

TEST(VoxelSampler, AdmitsOnePointPerCube) {
  VoxelSampler sut(100);
  sut.reset(0.5F, 100);

  EXPECT_TRUE(sut.admit({0.1F, 0.1F, 0.1F}));
  EXPECT_FALSE(sut.admit({0.4F, 0.4F, 0.4F}));
  EXPECT_TRUE(sut.admit({-0.1F, 0.1F, 0.1F}));
  sut.reset(0.5F, 1);
  EXPECT_TRUE(sut.admit({0.4F, 0.4F, 0.4F}));
}

TEST(VoxelSampler, AdmitsAllPointsOfDifferentCubesUpToItsCount) {
  VoxelSampler sut(1000);
  for (const std::size_t points : {std::size_t{1}, std::size_t{77}, std::size_t{1000}}) {
    sut.reset(0.25F, points);

    std::size_t admitted = 0;
    for (int pass = 0; pass < 2; ++pass) {
      for (std::size_t i = 0; i < points; ++i) {
        const auto x = static_cast<float>(i) - 500.0F;
        admitted += sut.admit({x, -x, 0.5F * x}) ? 1 : 0;
      }
    }

    EXPECT_EQ(admitted, points);
  }
}

}  // namespace
}  // namespace slamd::scan
