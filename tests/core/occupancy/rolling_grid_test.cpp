#include "core/occupancy/rolling_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace slamd::occupancy {
namespace {

using geometry::Se3;

Se3 at(double x, double y = 0.0, double z = 0.0) { return {Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, y, z)}; }

/// A scan from a place, whose points are given in odom.
CarvingScan scan_from(const Se3& T_odom_base, std::span<const Eigen::Vector3f> points_odom) {
  CarvingScan scan;
  scan.points_imu = points_odom;  // imu is odom here
  scan.T_odom_base = T_odom_base;
  scan.origin_odom = T_odom_base.translation();
  return scan;
}

GridConfig small() {
  GridConfig config;
  config.box_m = 12.8;  // 8 blocks
  config.height_m = 3.2;
  config.max_points = 400;
  return config;
}

CellState state(const RollingGrid& grid, double x, double y, double z) { return grid.states().at(cell_of({x, y, z}, grid.states().cell_m())); }

/// A wall across x, 0.1 m apart.
std::vector<Eigen::Vector3f> wall(float x) {
  std::vector<Eigen::Vector3f> points;
  for (float y = -0.95F; y < 1.0F; y += 0.1F) {
    for (float z = -0.45F; z < 0.5F; z += 0.1F) {
      points.emplace_back(x, y, z);
    }
  }
  return points;
}

TEST(RollingGrid, HasAWallOccupiedFreeInFrontAndUnknownBehind) {
  RollingGrid sut(small());
  const auto points = wall(3.1F);

  sut.insert(scan_from(at(0.0), points));

  EXPECT_EQ(state(sut, 3.1, 0.0, 0.1), CellState::kOccupied);
  EXPECT_EQ(state(sut, 2.5, 0.0, 0.1), CellState::kFree);
  EXPECT_EQ(state(sut, 3.5, 0.0, 0.1), CellState::kUnknown);
  EXPECT_EQ(state(sut, 50.0, 0.0, 0.1), CellState::kUnknown);
}

TEST(RollingGrid, ForgetsWhatHasMovedAway) {
  RollingGrid sut(small());
  const auto far = wall(5.1F);
  for (int i = 0; i < 30; ++i) {
    sut.insert(scan_from(at(0.0), wall(2.1F)));
  }
  ASSERT_EQ(state(sut, 2.1, 0.1, 0.1), CellState::kOccupied);

  int scans = 0;
  while (state(sut, 2.1, 0.1, 0.1) == CellState::kOccupied && scans < 100) {
    sut.insert(scan_from(at(0.0), far));
    ++scans;
  }

  EXPECT_EQ(scans, 14) << "what was seen for long goes last";
}

TEST(RollingGrid, KeepsGroundThatRaysOnlyGraze) {
  RollingGrid sut(small());
  const float height = 0.8F;
  const auto ring = [&](float radius) {
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 360; ++i) {
      const float a = static_cast<float>(i) * 0.01745F;
      points.emplace_back(radius * std::cos(a), radius * std::sin(a), -height + 0.01F);
    }
    return points;
  };
  sut.insert(scan_from(at(0.0), ring(4.9F)));
  ASSERT_EQ(state(sut, 4.9, 0.05, -0.79), CellState::kOccupied);

  for (int i = 0; i < 10; ++i) {
    sut.insert(scan_from(at(0.0), ring(5.9F)));  // these rays pass 0.13 m above it, in the same cells
    EXPECT_EQ(state(sut, 4.9, 0.05, -0.79), CellState::kOccupied);
  }
}

TEST(RollingGrid, NeverShowsTheRobotItself) {
  GridConfig config = small();
  config.body.push_back({{-0.5F, -0.3F, -0.3F}, {0.5F, 0.3F, 0.3F}});
  RollingGrid sut(config);
  const std::vector<Eigen::Vector3f> person{{1.05F, 0.05F, 0.05F}, {1.05F, 0.05F, 0.25F}};
  sut.insert(scan_from(at(0.0), person));
  ASSERT_EQ(state(sut, 1.05, 0.05, 0.05), CellState::kOccupied);
  EXPECT_EQ(state(sut, 0.0, 0.0, -0.1), CellState::kFree);

  sut.insert(scan_from(at(1.0), person));  // a point on the hull that the filter has let through

  EXPECT_EQ(state(sut, 1.05, 0.05, 0.05), CellState::kFree);
}

TEST(RollingGrid, CountsTheChangesOfBlocksThatItMakesOrForgets) {
  RollingGrid sut(small());
  const std::uint64_t begin = sut.changes().newest();
  EXPECT_EQ(begin, sut.states().size()) << "each block has entered the window";
  EXPECT_EQ(sut.digest(), 0U);

  sut.set_submap(7);
  sut.insert(scan_from(at(0.0), wall(3.1F)));
  const std::uint64_t after = sut.changes().newest();
  const auto changed = sut.changes().after(begin);
  ASSERT_FALSE(changed.empty());
  EXPECT_EQ(after - begin, changed.size());
  for (const std::uint32_t slot : changed) {
    EXPECT_FALSE(sut.states().block(slot).all_unknown());
    EXPECT_EQ(sut.submap(slot), 7);
  }
  sut.insert(scan_from(at(100.0), {}));

  EXPECT_EQ(sut.digest(), 0U) << "all left behind";
  EXPECT_EQ(sut.changes().newest() - after, sut.states().size());
}

/// The same in the simplest form: a cell of its own for each place, all of odom, no blocks.
class DenseModel {
 public:
  using Key = std::tuple<int, int, int>;

  void insert(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3f> points, const RollingGrid& grid) {
    const double cell_m = grid.states().cell_m();
    const Window& window = grid.states().window();
    const BlockIndex& first = window.first;
    std::erase_if(cells_, [&](const auto& entry) {
      const auto& [x, y, z] = entry.first;
      return !window.contains(CellIndex{x, y, z}.block());
    });
    const Eigen::Vector3d corner = 8.0 * cell_m * Eigen::Vector3d(first.x, first.y, first.z);
    const auto local = [&](const Eigen::Vector3d& p) { return Eigen::Vector3f(((p - corner) / cell_m).cast<float>()); };
    const auto key = [&](const std::array<std::int32_t, 3>& c) { return Key(8 * first.x + c[0], 8 * first.y + c[1], 8 * first.z + c[2]); };
    std::set<Key> hits;
    std::map<Key, bool> missed;  // through, or grazed only
    const Eigen::Vector3f from = local(origin);
    for (const Eigen::Vector3f& p : points) {
      const Eigen::Vector3f end = local(p.cast<double>());
      const Key hit = key({static_cast<int>(std::floor(end.x())), static_cast<int>(std::floor(end.y())), static_cast<int>(std::floor(end.z()))});
      hits.insert(hit);
      cells_[hit].place = ((end - Eigen::Vector3f(end.array().floor())) * 32.0F).array().floor();
    }
    for (const Eigen::Vector3f& p : points) {
      const Eigen::Vector3f end = local(p.cast<double>());
      const float reach = (end - from).cwiseAbs().maxCoeff();
      const Eigen::Vector3f step = (end - from) / reach;
      for (int k = 0; k <= static_cast<int>(reach); ++k) {
        const Eigen::Vector3f low = (from + static_cast<float>(k) * step).array().floor();
        const std::array<std::int32_t, 3> c{static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z())};
        const Cell& cell = cells_[key(c)];
        const Eigen::Vector3f place = low + (cell.place.array() + 0.5F).matrix() / 32.0F;
        const bool through = cell.evidence <= 0 || ((place - from).cross((end - from).normalized()).norm() <= 0.5F && k <= static_cast<int>(reach) - 2);
        missed[key(c)] = missed[key(c)] || through;
      }
    }
    for (const auto& [k, through] : missed) {
      if (!hits.contains(k)) {
        cells_[k].add(through ? -8 : -1);
      }
    }
    for (const Key& k : hits) {
      cells_[k].add(40);
    }
  }

  CellState at(const CellIndex& cell) const {
    const auto found = cells_.find({cell.x, cell.y, cell.z});
    return found == cells_.end() ? CellState::kUnknown : found->second.state;
  }

 private:
  struct Cell {
    int evidence = 0;
    CellState state = CellState::kUnknown;
    Eigen::Vector3f place = Eigen::Vector3f::Zero();

    void add(int change) {
      evidence = std::clamp(evidence + change, -20, 100);
      state = evidence >= 20 ? CellState::kOccupied : evidence <= -8 ? CellState::kFree : state;
    }
  };

  std::map<Key, Cell> cells_;
};

TEST(RollingGrid, IsWhatAPlainGridWouldBe) {
  std::mt19937_64 engine(11);
  std::uniform_real_distribution<float> any(-1.0F, 1.0F);
  for (int run = 0; run < 6; ++run) {
    GridConfig config = small();
    config.box_m = 8.0;
    RollingGrid sut(config);
    DenseModel model;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (int scan = 0; scan < 25; ++scan) {
      place += Eigen::Vector3d(any(engine), any(engine), 0.2F * any(engine));
      std::vector<Eigen::Vector3f> points;
      for (int i = 0; i < 40; ++i) {  // of a few fixed things, so that cells are hit again
        points.push_back(Eigen::Vector3f(std::floor(3.0F * any(engine)), std::floor(3.0F * any(engine)), 0.4F * any(engine)) + 0.02F * Eigen::Vector3f(any(engine), any(engine), any(engine)));
      }
      const CarvingScan whole = scan_from(Se3(Eigen::Matrix3d::Identity(), place), points);
      sut.insert(whole);
      // What lies outside the window is another test's.
      std::erase_if(points, [&](const Eigen::Vector3f& p) { return !sut.states().window().contains(cell_of(p.cast<double>(), config.cell_m).block()); });
      if (points.size() != 40) {
        sut.restart(place);
        model = {};
        sut.insert(scan_from(Se3(Eigen::Matrix3d::Identity(), place), points));
      }
      model.insert(place, points, sut);

      std::uint64_t digest = 0;
      for (std::size_t slot = 0; slot < sut.states().size(); ++slot) {
        const BlockIndex block = sut.states().window().block_at(slot);
        digest += sut.states().block(slot).digest(block);
        for (int i = 0; i < kBlockCells; ++i) {
          const CellIndex cell{8 * block.x + i % 8, 8 * block.y + i / 8 % 8, 8 * block.z + i / 64};
          ASSERT_EQ(sut.states().at(cell), model.at(cell)) << "run " << run << ", scan " << scan << ", cell " << cell.x << " " << cell.y << " " << cell.z;
        }
      }
      ASSERT_EQ(sut.digest(), digest);
    }
  }
}

TEST(RollingGrid, CarvesUpToItsBorderWhereARayGoesOn) {
  RollingGrid sut(small());
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 100; ++i) {
    const float a = static_cast<float>(i) * 0.0628F;
    points.emplace_back(200.0F * std::cos(a), 200.0F * std::sin(a), 0.1F);
  }
  points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);

  sut.insert(scan_from(at(0.0, 0.0, 0.1), points));

  const Window& window = sut.states().window();
  const double last = 1.6 * (window.first.x + window.size[0]) - 0.1;
  EXPECT_EQ(state(sut, last, 0.05, 0.1), CellState::kFree);
  std::uint64_t occupied = 0;
  for (std::size_t slot = 0; slot < sut.states().size(); ++slot) {
    for (const std::uint64_t word : sut.states().block(slot).occupied) {
      occupied |= word;
    }
  }
  EXPECT_EQ(occupied, 0U);
}

TEST(RollingGrid, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  RollingGrid sut(small());
  const auto points = wall(3.1F);

  const std::size_t allocations = support::count_allocations([&] {
    for (int i = 0; i < 10; ++i) {
      sut.insert(scan_from(at(0.7 * i), points));
    }
    sut.restart(Eigen::Vector3d::Ones());
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::occupancy
