#include "core/occupancy/queries.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace slamd::occupancy {
namespace {

constexpr double kCell_m = 0.2;

/// A map of scattered cells about odom's origin.
StateMap scattered(std::mt19937_64& engine, unsigned one_in) {
  StateMap map(Window{{-2, -2, -1}, {4, 4, 2}}, kCell_m);
  for (std::size_t slot = 0; slot < map.size(); ++slot) {
    for (int place = 0; place < kBlockCells; ++place) {
      map.block(slot).set(place, engine() % one_in == 0 ? CellState::kOccupied : engine() % 10 == 0 ? CellState::kUnknown : CellState::kFree);
    }
  }
  return map;
}

/// Calls visit(cell) for each cell of the window.
template <typename Visit>
void for_each_cell(Visit&& visit) {
  for (std::int32_t z = -8; z < 8; ++z) {
    for (std::int32_t y = -16; y < 16; ++y) {
      for (std::int32_t x = -16; x < 16; ++x) {
        visit(CellIndex{x, y, z});
      }
    }
  }
}

Eigen::Vector3d any_point(std::mt19937_64& engine, double reach_m) {
  std::uniform_real_distribution<double> any(-reach_m, reach_m);
  return {any(engine), any(engine), 0.5 * any(engine)};
}

TEST(Queries, CountTheCellsOfABoxAsALoopDoes) {
  std::mt19937_64 engine(3);
  const StateMap map = scattered(engine, 20);
  for (int run = 0; run < 50; ++run) {
    const Eigen::Vector3d a = any_point(engine, 4.0);
    const Eigen::Vector3d b = any_point(engine, 4.0);
    const CellIndex low = cell_of(a.cwiseMin(b), kCell_m);
    const CellIndex high = cell_of(a.cwiseMax(b), kCell_m);
    CellCounts expected;
    for (std::int32_t z = low.z; z <= high.z; ++z) {
      for (std::int32_t y = low.y; y <= high.y; ++y) {
        for (std::int32_t x = low.x; x <= high.x; ++x) {
          const CellState state = state_at(map, centre_of({x, y, z}, kCell_m));
          ++(state == CellState::kFree ? expected.free : state == CellState::kOccupied ? expected.occupied : expected.unknown);
        }
      }
    }

    const CellCounts counts = count_cells(map, a.cwiseMin(b), a.cwiseMax(b));

    ASSERT_EQ(counts.free, expected.free);
    ASSERT_EQ(counts.occupied, expected.occupied);
    ASSERT_EQ(counts.unknown, expected.unknown);
  }
}

TEST(Queries, FindTheNearestObstacleAsALoopDoes) {
  std::mt19937_64 engine(4);
  for (int run = 0; run < 60; ++run) {
    const StateMap map = scattered(engine, run % 2 == 0 ? 3000 : 200);
    const Eigen::Vector3d p = any_point(engine, run % 3 == 0 ? 6.0 : 3.0);
    const double radius_m = run % 4 == 0 ? std::numeric_limits<double>::infinity() : 1.0;
    double expected = radius_m;
    bool any = false;
    for_each_cell([&](const CellIndex& cell) {
      const Eigen::Vector3d low = kCell_m * Eigen::Vector3d(cell.x, cell.y, cell.z);
      const double distance = (low - p).cwiseMax(p - low - Eigen::Vector3d::Constant(kCell_m)).cwiseMax(0.0).norm();
      if (map.at(cell) == CellState::kOccupied && distance <= expected) {
        expected = distance;
        any = true;
      }
    });

    const auto obstacle = nearest_obstacle(map, p, radius_m);

    ASSERT_EQ(obstacle.has_value(), any) << "run " << run;
    if (any) {
      ASSERT_NEAR(obstacle->distance_m, expected, 1e-9);
      ASSERT_EQ(map.at(obstacle->cell), CellState::kOccupied);
    }
  }
}

TEST(Queries, KnowNothingOfNoWindowNorOfWhatLiesBeyondAll) {
  const StateMap none;
  std::mt19937_64 engine(5);
  const StateMap map = scattered(engine, 20);
  const double infinite = std::numeric_limits<double>::infinity();

  EXPECT_EQ(none.size(), 0U);
  EXPECT_EQ(state_at(none, Eigen::Vector3d::Zero()), CellState::kUnknown);
  EXPECT_EQ(count_cells(none, {-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}).unknown, 64U);
  EXPECT_EQ(cast_ray(none, Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), true)->state, CellState::kUnknown);
  EXPECT_FALSE(cast_ray(none, Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), false));
  EXPECT_FALSE(nearest_obstacle(none, Eigen::Vector3d::Zero(), infinite));
  EXPECT_FALSE(nearest_obstacle(map, Eigen::Vector3d(1e12, 0.0, 0.0), infinite));
  EXPECT_FALSE(nearest_obstacle(map, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), infinite));
}

TEST(Queries, CastRaysToTheFirstCellThatBlocks) {
  StateMap map(Window{{0, 0, 0}, {2, 1, 1}}, kCell_m);
  map.block(0).free.fill(~std::uint64_t{0});
  map.block(1).free.fill(~std::uint64_t{0});
  map.block(map.window().slot_of({1, 0, 0})).set(CellIndex{12, 3, 3}.place(), CellState::kOccupied);
  const Eigen::Vector3d from(0.1, 0.7, 0.7);

  const auto wall = cast_ray(map, from, from + Eigen::Vector3d(10.0, 0.0, 0.0), false);
  const auto edge = cast_ray(map, from, from + Eigen::Vector3d(0.0, 2.0, 0.0), true);

  ASSERT_TRUE(wall);
  EXPECT_EQ(wall->cell, (CellIndex{12, 3, 3}));
  EXPECT_NEAR(wall->distance_m, 2.4, 1e-9);
  EXPECT_FALSE(cast_ray(map, from, from + Eigen::Vector3d(2.0, 0.0, 0.0), false)) << "short of it";
  ASSERT_TRUE(edge);
  EXPECT_EQ(edge->state, CellState::kUnknown);
  EXPECT_FALSE(cast_ray(map, from, from + Eigen::Vector3d(0.0, 2.0, 0.0), false));
  EXPECT_FALSE(cast_ray(map, from, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), true));
}

}  // namespace
}  // namespace slamd::occupancy
