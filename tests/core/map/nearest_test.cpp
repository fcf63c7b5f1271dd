#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "core/map/voxel_map.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::map {
namespace {

std::vector<Eigen::Vector3f> random_points(std::mt19937_64& engine, std::size_t count, float extent_m) {
  std::uniform_real_distribution<float> uniform(-extent_m, extent_m);
  std::vector<Eigen::Vector3f> points(count);
  for (auto& p : points) {
    p = {uniform(engine), uniform(engine), 0.3F * uniform(engine)};
  }
  return points;
}

std::vector<Eigen::Vector3f> stored_points(const VoxelMap& map) {
  std::vector<Eigen::Vector3f> points;
  map.for_each_point([&](const Eigen::Vector3f& p) { points.push_back(p); });
  return points;
}

TEST(VoxelMap, NearestAgreesWithBruteForce) {
  std::mt19937_64 engine(1);
  for (const std::size_t count : {50U, 2000U, 20000U}) {
    // Few cells, so that some are recycled, and a part that the window has left.
    VoxelMap sut(VoxelMapConfig{.window_m = 10.0F, .max_cells = 1000});
    sut.insert(random_points(engine, count / 2, 9.0F), 0.0);
    sut.insert(random_points(engine, count / 2, 12.0F), 8.0);
    sut.insert(random_points(engine, count, 12.0F), 16.0);
    const std::vector<Eigen::Vector3f> stored = stored_points(sut);
    for (const Eigen::Vector3f& query : random_points(engine, 300, 13.0F)) {
      std::vector<float> expected;
      for (const Eigen::Vector3f& p : stored) {
        const float distance_sq = (p - query).squaredNorm();
        if (distance_sq < 1.0F) {
          expected.push_back(distance_sq);
        }
      }
      std::sort(expected.begin(), expected.end());
      const float sixth = expected.size() > Neighbours::kMax ? expected[Neighbours::kMax] : 1.0F;
      expected.resize(std::min<std::size_t>(expected.size(), Neighbours::kMax));

      const Neighbours found = sut.nearest(query, 1.0F);

      ASSERT_EQ(found.count, expected.size());
      ASSERT_NEAR(found.others_beyond_sq_m2, sixth, 1e-5F);
      for (std::size_t i = 0; i < found.count; ++i) {
        ASSERT_NEAR(found.distance_sq_m2[i], expected[i], 1e-5F);
        ASSERT_NEAR((found.points_odom[i] - query).squaredNorm(), found.distance_sq_m2[i], 1e-5F);
      }
    }
  }
}

TEST(VoxelMap, VectorSearchGivesTheBitsOfItsScalarTwin) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::uniform_int_distribution<int> tenths(0, 10);  // many equal distances
  const CellSearch fastest = fastest_cell_search();
  for (std::uint32_t count = 0; count <= PointCell::kMaxPoints; ++count) {
    for (const bool ties : {false, true}) {
      const auto coordinate = [&] { return ties ? 0.1F * static_cast<float>(tenths(engine)) : uniform(engine); };
      std::array<PointCell, 3> cells;
      for (PointCell& cell : cells) {
        for (std::uint32_t i = 0; i < count; ++i) {
          cell.add({coordinate(), coordinate(), coordinate()});
        }
      }
      const std::array<CellVisit, 3> visits{CellVisit{&cells[0], 0.0F}, {&cells[1], 0.02F}, {&cells[2], 0.3F}};
      const Eigen::Vector3f query(coordinate(), coordinate(), coordinate());
      Nearest expected(0.5F);
      Nearest found(0.5F);

      search_cells_scalar(visits, 0, query, expected);
      fastest(visits, 0, query, found);

      ASSERT_EQ(found.keys, expected.keys);
    }
  }
}

TEST(VoxelMap, KeepsOnePointPerSubCube) {
  std::mt19937_64 engine(3);
  VoxelMap sut(VoxelMapConfig{});
  for (int i = 0; i < 20; ++i) {
    sut.insert(random_points(engine, 5000, 2.0F), 0.0);
  }

  for (const Eigen::Vector3f& p : stored_points(sut)) {
    const Neighbours found = sut.nearest(p, 1.0F);
    ASSERT_EQ(found.distance_sq_m2[0], 0.0F);
  }
  EXPECT_LE(stored_points(sut).size(), 16U * 16U * 6U);  // 4 m × 4 m × 1.2 m in sub-cubes of 0.25 m
}

TEST(VoxelMap, ForgetsWhatLeftTheWindow) {
  VoxelMap sut(VoxelMapConfig{.window_m = 100.0F});
  const std::vector<Eigen::Vector3f> first{{0.5F, 0.5F, 0.5F}};
  const std::vector<Eigen::Vector3f> second{{50.5F, 0.5F, 0.5F}};
  sut.insert(first, 0.0);
  sut.insert(second, 99.0);
  EXPECT_EQ(sut.nearest(first[0], 1.0F).count, 1U);

  sut.insert({}, 101.0);

  EXPECT_EQ(sut.nearest(first[0], 1.0F).count, 0U);
  EXPECT_EQ(sut.nearest(second[0], 1.0F).count, 1U);
  EXPECT_EQ(sut.surface(first[0], 0), nullptr);
}

TEST(VoxelMap, RecyclesTheOldestCellWhenFull) {
  VoxelMap sut(VoxelMapConfig{.max_cells = 100, .max_surface_cells = 600});
  std::vector<Eigen::Vector3f> line;
  for (int i = 0; i < 300; ++i) {
    line.emplace_back(static_cast<float>(i) + 0.5F, 0.5F, 0.5F);
  }

  sut.insert(line, 0.0);

  EXPECT_EQ(sut.cells(), 100U);
  EXPECT_EQ(sut.recycled(), 200U);
  EXPECT_EQ(sut.nearest(line[150], 1.0F).count, 0U);
  EXPECT_GE(sut.nearest(line[250], 1.0F).count, 1U);
}

TEST(VoxelMap, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::mt19937_64 engine(4);
  VoxelMap sut(VoxelMapConfig{.window_m = 10.0F, .max_cells = 500, .max_surface_cells = 2000});
  const std::vector<Eigen::Vector3f> points = random_points(engine, 5000, 30.0F);

  const std::size_t allocations = support::count_allocations([&] {
    for (int i = 0; i < 20; ++i) {
      sut.insert(points, 3.0 * i);
      sut.nearest(points[static_cast<std::size_t>(i)], 1.0F);
    }
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_GT(sut.recycled(), 0U);
}

}  // namespace
}  // namespace slamd::map
