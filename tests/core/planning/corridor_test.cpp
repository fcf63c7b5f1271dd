#include "core/planning/corridor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace slamd::planning {
namespace {

using occupancy::BlockIndex;
using occupancy::CellIndex;
using occupancy::CellState;
using occupancy::StateMap;
using occupancy::Window;

constexpr double kCell_m = 0.2;

/// Free space of 19.2 × 19.2 × 6.4 m about the origin.
StateMap free_space() {
  StateMap map(Window{{-6, -6, -2}, {12, 12, 4}}, kCell_m);
  for (std::size_t slot = 0; slot < map.size(); ++slot) {
    map.block(slot).free.fill(~std::uint64_t{0});
  }
  return map;
}

void set(StateMap& map, const CellIndex& cell, CellState state) {
  if (map.window().contains(cell.block())) {
    map.block(map.window().slot_of(cell.block())).set(cell.place(), state);
  }
}

/// Some pillars, walls with gaps and things in the air.
StateMap cluttered(std::mt19937_64& engine) {
  StateMap map = free_space();
  const auto any = [&engine](int from, int to) { return from + static_cast<int>(engine() % static_cast<unsigned>(to - from)); };
  for (int thing = 0; thing < 30; ++thing) {
    const CellIndex corner{any(-48, 48), any(-48, 48), any(-16, 14)};
    const int kind = any(0, 3);
    const CellIndex size{kind == 1 ? any(4, 20) : any(1, 4), kind == 2 ? any(4, 20) : any(1, 4), kind == 0 ? 20 : any(1, 8)};
    const CellState state = any(0, 5) == 0 ? CellState::kUnknown : CellState::kOccupied;
    for (int x = 0; x < size.x; ++x) {
      for (int y = 0; y < size.y; ++y) {
        for (int z = 0; z < size.z; ++z) {
          set(map, {corner.x + x, corner.y + y, corner.z + z}, state);
        }
      }
    }
  }
  return map;
}

/// How far a cell lies outside the plane that it is outside of the most; below zero: it may reach in.
double outside_by(const Polyhedron& polyhedron, const CellIndex& cell) {
  const Eigen::Vector3d middle = occupancy::centre_of(cell, kCell_m);
  double most = -1e9;
  for (const HalfSpace& plane : polyhedron.planes) {
    const double reach = 0.5 * kCell_m * Eigen::Vector3d::Map(plane.normal).cwiseAbs().sum();
    most = std::max(most, -plane.room(middle) - reach);
  }
  return most;
}

/// How near a blocked cell comes to a way, by trying points of it.
double clearance(const StateMap& map, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  double least = 1e9;
  for (int i = 0; i <= 100; ++i) {
    const Eigen::Vector3d p = a + 0.01 * i * (b - a);
    const CellIndex home = occupancy::cell_of(p, kCell_m);
    for (int z = -4; z <= 4; ++z) {
      for (int y = -4; y <= 4; ++y) {
        for (int x = -4; x <= 4; ++x) {
          const CellIndex cell{home.x + x, home.y + y, home.z + z};
          if (map.at(cell) != CellState::kFree) {
            const Eigen::Vector3d low = kCell_m * Eigen::Vector3d(cell.x, cell.y, cell.z);
            least = std::min(least, (low - p).cwiseMax(p - low - Eigen::Vector3d::Constant(kCell_m)).cwiseMax(0.0).norm());
          }
        }
      }
    }
  }
  return least;
}

TEST(Corridor, HoldsThePathAndNoObstacleAndItsPiecesOverlap) {
  std::mt19937_64 engine(21);
  std::uniform_real_distribution<double> any(-6.0, 6.0);
  CorridorConfig config;
  config.radius_m = 0.3;
  CorridorBuilder sut(config);
  BoundedVector<CorridorPiece> pieces(8);
  int made = 0;
  for (int run = 0; run < 40; ++run) {
    const StateMap map = cluttered(engine);
    std::vector<Eigen::Vector3d> path{{any(engine), any(engine), 0.0}};
    for (int i = 0; i < 3; ++i) {
      path.push_back(path.back() + Eigen::Vector3d(0.3 * any(engine), 0.3 * any(engine), 0.05 * any(engine)));
    }
    const CorridorResult result = sut.build(map, path, pieces);
    std::size_t sound = 0;  // segments before the first that is too close
    while (sound + 1 < path.size() && clearance(map, path[sound], path[sound + 1]) > config.radius_m + 0.02) {
      ++sound;
    }

    ASSERT_GE(pieces.size(), sound) << "run " << run << ": there is room for more, fault " << static_cast<int>(result.fault);
    ASSERT_EQ(pieces.size(), result.fault == CorridorFault::kNone ? path.size() - 1 : result.segment);
    for (std::size_t i = 0; i < pieces.size(); ++i, ++made) {
      const Polyhedron& polyhedron = pieces[i].polyhedron;
      ASSERT_GE(polyhedron.room(path[i]), config.radius_m) << "run " << run;
      ASSERT_GE(polyhedron.room(path[i + 1]), config.radius_m) << "so the next one overlaps";
      ASSERT_LE(pieces[i].ellipsoid.level(path[i]), 1.0 + 1e-6);
      for (int z = -18; z < 18; ++z) {
        for (int y = -56; y < 56; ++y) {
          for (int x = -56; x < 56; ++x) {
            const CellIndex cell{x, y, z};
            if (map.at(cell) != CellState::kFree) {
              ASSERT_GE(outside_by(polyhedron, cell), -1e-6) << "run " << run << ", segment " << i;
            }
          }
        }
      }
    }
  }
  EXPECT_GT(made, 40);
}

TEST(Corridor, SaysWhereAPathIsTooClose) {
  StateMap map = free_space();
  set(map, {10, 0, 0}, CellState::kOccupied);
  CorridorBuilder sut({.radius_m = 0.3});
  BoundedVector<CorridorPiece> pieces(4);
  const std::vector<Eigen::Vector3d> path{{-2.0, 0.1, 0.1}, {0.0, 0.1, 0.1}, {4.0, 0.1, 0.1}};

  const CorridorResult result = sut.build(map, path, pieces);

  EXPECT_EQ(result.fault, CorridorFault::kTooClose);
  EXPECT_EQ(result.segment, 1U);
  EXPECT_EQ(pieces.size(), 1U);
}

TEST(Corridor, IsAsWideAsItsReachWhereNothingIs) {
  const StateMap map = free_space();
  CorridorBuilder sut({.radius_m = 0.3, .reach_m = 1.0});
  BoundedVector<CorridorPiece> pieces(1);
  const std::vector<Eigen::Vector3d> path{{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};

  ASSERT_EQ(sut.build(map, path, pieces).fault, CorridorFault::kNone);

  EXPECT_EQ(pieces[0].polyhedron.planes.size(), 6U);
  EXPECT_NEAR(pieces[0].polyhedron.room({0.0, 0.9, 0.0}), 0.1, 1e-9);
}

TEST(Corridor, MayGoThroughTheUnknownAndStandsOnTheGround) {
  StateMap map = free_space();
  for (int y = -20; y < 20; ++y) {
    for (int x = -20; x < 20; ++x) {
      set(map, {x, y, -3}, CellState::kOccupied);  // the ground, its upper side 0.4 m below the path
      set(map, {x, y, 4}, CellState::kUnknown);
    }
  }
  BoundedVector<CorridorPiece> pieces(1);
  const std::vector<Eigen::Vector3d> path{{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};

  CorridorBuilder wary({.radius_m = 0.35});
  ASSERT_EQ(wary.build(map, path, pieces).fault, CorridorFault::kNone);
  EXPECT_LT(pieces[0].polyhedron.room({0.0, 0.0, 0.85}), 0.0) << "unknown above";
  CorridorBuilder bold({.radius_m = 0.35, .unknown_blocks = false, .floor_m = 0.4});
  ASSERT_EQ(bold.build(map, path, pieces).fault, CorridorFault::kNone);
  EXPECT_EQ(pieces[0].polyhedron.planes.size(), 6U) << "the ground is a plane";
  EXPECT_NEAR(pieces[0].polyhedron.room({0.0, 0.0, -0.4}), 0.0, 1e-9);
  EXPECT_GT(pieces[0].polyhedron.room({0.0, 0.0, 0.85}), 0.0);
}

TEST(Corridor, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::mt19937_64 engine(3);
  const StateMap map = cluttered(engine);
  CorridorBuilder sut({});
  BoundedVector<CorridorPiece> pieces(1);
  const std::vector<Eigen::Vector3d> path{{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};

  EXPECT_EQ(support::count_allocations([&] { sut.build(map, path, pieces); }), 0U);
}

}  // namespace
}  // namespace slamd::planning
