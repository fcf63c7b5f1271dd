#include "core/occupancy/ray_walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace slamd::occupancy {
namespace {

using Cell = std::array<std::int32_t, 3>;

/// Whether the way from a to b meets a cell that is larger by `margin` on each side.
bool meets(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Cell& cell, float margin) {
  float enters = 0.0F;
  float leaves = 1.0F;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = static_cast<float>(cell[static_cast<std::size_t>(axis)]) - margin;
    const float high = low + 1.0F + 2.0F * margin;
    const float d = b[axis] - a[axis];
    if (d == 0.0F) {
      if (a[axis] < low || a[axis] > high) {
        return false;
      }
      continue;
    }
    const float t0 = (low - a[axis]) / d;
    const float t1 = (high - a[axis]) / d;
    enters = std::max(enters, std::min(t0, t1));
    leaves = std::min(leaves, std::max(t0, t1));
  }
  return enters <= leaves;
}

std::vector<Cell> walked(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  std::vector<Cell> cells;
  walk_ray(a, b, [&](const Cell& cell, std::int32_t) {
    cells.push_back(cell);
    return true;
  });
  return cells;
}

TEST(WalkRay, VisitsTheCellsThatTheRayMeetsAndNoOthers) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<float> any(-6.0F, 6.0F);
  for (int run = 0; run < 500; ++run) {
    Eigen::Vector3f a(any(engine), any(engine), any(engine));
    Eigen::Vector3f b(any(engine), any(engine), any(engine));
    if (run % 5 == 0) {
      b[run % 3] = a[run % 3];  // along a plane of cells
    }
    const std::vector<Cell> cells = walked(a, b);

    ASSERT_EQ(cells.back(), (Cell{static_cast<int>(std::floor(b.x())), static_cast<int>(std::floor(b.y())), static_cast<int>(std::floor(b.z()))}));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      ASSERT_TRUE(meets(a, b, cells[i], 1e-3F)) << "run " << run;
      if (i > 0) {
        ASSERT_EQ(std::abs(cells[i][0] - cells[i - 1][0]) + std::abs(cells[i][1] - cells[i - 1][1]) + std::abs(cells[i][2] - cells[i - 1][2]), 1);
      }
    }
    for (int x = -7; x < 7; ++x) {
      for (int y = -7; y < 7; ++y) {
        for (int z = -7; z < 7; ++z) {
          ASSERT_TRUE(!meets(a, b, {x, y, z}, -1e-3F) || std::count(cells.begin(), cells.end(), Cell{x, y, z}) == 1) << "run " << run;
        }
      }
    }
  }
}

TEST(WalkRay, SaysHowManyStepsAreLeftAndStopsWhenTold) {
  std::vector<std::int32_t> left;

  walk_ray({0.5F, 0.5F, 0.5F}, {5.5F, 0.5F, 0.5F}, [&](const Cell&, std::int32_t steps) {
    left.push_back(steps);
    return left.size() < 3;
  });

  EXPECT_EQ(left, (std::vector<std::int32_t>{5, 4, 3}));
}

}  // namespace
}  // namespace slamd::occupancy
