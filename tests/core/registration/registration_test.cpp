#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "core/geometry/so3.hpp"
#include "core/map/voxel_map.hpp"
#include "core/registration/association.hpp"
#include "core/registration/constraint.hpp"
#include "core/registration/gauss_newton.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/world/room.hpp"

namespace slamd::registration {
namespace {

using geometry::Se3;
using geometry::Vector6d;

const Se3 kTruth(geometry::so3_exp({0.02, -0.01, 0.7}), Eigen::Vector3d(0.5, -0.5, 1.0));

map::VoxelMap map_of_room(std::mt19937_64& engine) {
  map::VoxelMap map(map::VoxelMapConfig{});
  for (int i = 0; i < 12; ++i) {
    const Se3 T_odom_lidar(geometry::so3_exp({0.05 * i, 0.03 * i, 0.5 * i}), Eigen::Vector3d(0.3 * i - 1.5, 0.1 * i, 1.2));
    std::vector<Eigen::Vector3f> points = world::Room().points_lidar(T_odom_lidar, 720, 0.01, engine);
    for (Eigen::Vector3f& p : points) {
      p = (T_odom_lidar * p.cast<double>()).cast<float>();
    }
    map.insert(points, 0.0);
  }
  return map;
}

TEST(Associate, GivesNoConstraintsAtAPoseThatIsNoNumberThoughItHadSome) {
  map::VoxelMap map(map::VoxelMapConfig{});
  std::vector<Eigen::Vector3f> floor;
  for (int i = 0; i < 64; ++i) {
    floor.emplace_back(0.26F * static_cast<float>(i % 8), 0.26F * static_cast<float>(i / 8), 0.0F);
  }
  map.insert(floor, 0.0);
  scan::DeskewedScan scan(scan::PreprocessConfig{});
  scan.planar.push_back({Eigen::Vector3f(1.0F, 1.0F, 0.0F), 1.4F});
  Association sut{scan::PreprocessConfig{}};
  sut.begin(scan);
  associate(scan, map, Se3(), {}, sut);
  ASSERT_EQ(sut.constraints.size(), 1U);
  const double nan = std::numeric_limits<double>::quiet_NaN();

  associate(scan, map, Se3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(nan, 0.0, 0.0)), {}, sut);

  EXPECT_EQ(sut.constraints.size(), 0U);
}

TEST(Linearize, GradientMatchesTheNumericDerivativeOfTheCost) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  std::vector<Constraint> constraints;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3f n = Eigen::Vector3f(uniform(engine), uniform(engine), uniform(engine)).normalized();
    constraints.push_back({10.0F * Eigen::Vector3f(uniform(engine), uniform(engine), uniform(engine)), n,
                           uniform(engine), 1.0F + uniform(engine) * 0.5F});
  }
  for (const double kernel_m : {0.5, std::numeric_limits<double>::infinity()}) {
    const NormalEquations sut = linearize(constraints, kTruth, kernel_m);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 6; ++i) {
      const Vector6d d = kStep * Vector6d::Unit(i);
      const double numeric = (linearize(constraints, geometry::boxplus(kTruth, d), kernel_m).cost -
                              linearize(constraints, geometry::boxplus(kTruth, -d), kernel_m).cost) /
                             (2.0 * kStep);

      EXPECT_NEAR(2.0 * sut.g[i], numeric, 1e-4 * std::abs(numeric) + 1e-4);
    }
  }
}

TEST(AlignToSurfaces, FindsThePoseFromHalfAMetreAndFiveDegrees) {
  std::mt19937_64 engine(2);
  const map::VoxelMap map = map_of_room(engine);
  const std::vector<Eigen::Vector3f> points = world::Room().points_lidar(kTruth, 60, 0.01, engine);
  BoundedVector<Constraint> scratch(2 * points.size());
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int found = 0;
  for (int run = 0; run < 40; ++run) {
    Vector6d error;
    error << 0.4 * uniform(engine), 0.4 * uniform(engine), 0.1 * uniform(engine), 0.02 * uniform(engine),
        0.02 * uniform(engine), 0.08 * uniform(engine);
    const GaussNewtonConfig config{.iterations = 20, .gate_first_m = 1.0F, .gate_last_m = 0.3F, .coarse_iterations = 10};

    const Se3 result = align_to_surfaces(points, map, geometry::boxplus(kTruth, error), config, scratch);

    const Vector6d left = geometry::boxminus(result, kTruth);
    found += left.head<3>().norm() < 0.03 && left.tail<3>().norm() < 0.01 ? 1 : 0;
  }

  EXPECT_GE(found, 36);
}

TEST(AlignToSurfaces, StaysWhereTheMapIsEmpty) {
  const map::VoxelMap map(map::VoxelMapConfig{});
  const std::vector<Eigen::Vector3f> points(50, Eigen::Vector3f(1.0F, 2.0F, 3.0F));
  BoundedVector<Constraint> scratch(100);

  const Se3 result = align_to_surfaces(points, map, kTruth, {}, scratch);

  EXPECT_EQ(geometry::boxminus(result, kTruth).norm(), 0.0);
}

TEST(AlignToSurfaces, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::mt19937_64 engine(3);
  const map::VoxelMap map = map_of_room(engine);
  const std::vector<Eigen::Vector3f> points = world::Room().points_lidar(kTruth, 30, 0.01, engine);
  BoundedVector<Constraint> scratch(2 * points.size());

  const std::size_t allocations = support::count_allocations([&] { align_to_surfaces(points, map, kTruth, {}, scratch); });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::registration
