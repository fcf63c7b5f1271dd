#include "tools/simulate/world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tools/simulate/town.hpp"

namespace slamd::simulate {
namespace {

constexpr double kFar_m = 120.0;

/// Rays as LiDARs cast them: from a man's height, in all directions but steep ones.
class RayGenerator {
 public:
  RayGenerator(const World& world, std::uint64_t seed) : world_(world), engine_(seed) {}

  void next(Eigen::Vector3d& origin, Eigen::Vector3d& direction) {
    const double x = uniform(0.02, 0.98) * world_.extent_m().x();
    const double y = uniform(0.02, 0.98) * world_.extent_m().y();
    origin = {x, y, world_.ground(x, y) + uniform(0.3, 3.0)};
    const double azimuth = uniform(-M_PI, M_PI);
    const double elevation = uniform(-0.7, 0.7);
    direction = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }

 private:
  const World& world_;
  std::mt19937_64 engine_;
};

World flat_world(std::uint64_t seed) { return {[](double, double) { return 0.0; }, {60.0, 60.0}, seed}; }

TEST(World, CastsAsTryingEverythingDoesAmongRandomThings) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    World sut = flat_world(seed);
    RayGenerator rays(sut, seed);
    for (int i = 0; i < 40; ++i) {
      const auto place = [&] { return rays.uniform(3.0, 57.0); };
      sut.add(OrientedBox{{place(), place(), 1.0}, {rays.uniform(0.1, 4.0), rays.uniform(0.1, 2.0), 1.5}, rays.uniform(-3.0, 3.0)});
      sut.add(Cylinder{{place(), place()}, rays.uniform(0.05, 0.5), 0.0, rays.uniform(1.0, 6.0)});
      sut.add(Crown{{place(), place(), 3.5}, rays.uniform(0.5, 2.5)});
    }
    sut.build();
    int hits = 0;
    for (std::uint64_t ray = 0; ray < 10'000; ++ray) {
      Eigen::Vector3d origin;
      Eigen::Vector3d direction;
      rays.next(origin, direction);

      Hit fast;
      Hit slow;
      const bool fast_met = sut.cast(origin, direction, kFar_m, ray, fast);
      const bool slow_met = sut.cast_brute_force(origin, direction, kFar_m, ray, slow);

      ASSERT_EQ(fast_met, slow_met) << "seed " << seed << ", ray " << ray;
      hits += fast_met ? 1 : 0;
      if (fast_met) {
        ASSERT_NEAR(fast.range_m, slow.range_m, 1e-5) << "seed " << seed << ", ray " << ray;
        ASSERT_EQ(fast.reflectivity, slow.reflectivity) << "seed " << seed << ", ray " << ray;
      }
    }
    EXPECT_GT(hits, 5000);
  }
}

TEST(World, CastsAsTryingEverythingDoesInATown) {
  for (const std::uint64_t seed : {1U, 7U}) {
    const Town town(seed);
    const World& sut = town.world();
    RayGenerator rays(sut, seed);
    constexpr std::uint64_t kRays = 4000;
    std::uint64_t different = 0;
    for (std::uint64_t ray = 0; ray < kRays; ++ray) {
      Eigen::Vector3d origin;
      Eigen::Vector3d direction;
      rays.next(origin, direction);

      Hit fast;
      Hit slow;
      const bool fast_met = sut.cast(origin, direction, kFar_m, ray, fast);
      const bool slow_met = sut.cast_brute_force(origin, direction, kFar_m, ray, slow);

      different += fast_met != slow_met || (fast_met && std::abs(fast.range_m - slow.range_m) > 1e-4) ? 1 : 0;
    }
    // Ground is searched in steps: a ray that skims a kerb may meet it in one and pass it in the other.
    EXPECT_LE(different, kRays / 400) << "seed " << seed;
  }
}

TEST(World, MeetsABoxWhereItsFaceIs) {
  World sut = flat_world(1);
  sut.add(OrientedBox{{30.0, 30.0, 1.0}, {1.0, 2.0, 1.0}, M_PI_2, 0.7F});
  sut.build();
  Hit hit;

  const bool met = sut.cast({20.0, 30.0, 1.0}, {1.0, 0.0, 0.0}, kFar_m, 0, hit);

  ASSERT_TRUE(met);
  EXPECT_NEAR(hit.range_m, 8.0, 1e-9);  // turned by 90°: two metres deep along x
  EXPECT_NEAR(hit.cos_incidence, 1.0, 1e-9);
  EXPECT_EQ(hit.reflectivity, 0.7F);
}

TEST(World, MeetsACylinderOnItsNearSideAndPassesAboveIt) {
  World sut = flat_world(1);
  sut.add(Cylinder{{30.0, 30.0}, 0.25, 0.0, 2.0});
  sut.build();
  Hit hit;

  EXPECT_TRUE(sut.cast({20.0, 30.0, 1.0}, {1.0, 0.0, 0.0}, kFar_m, 0, hit));
  EXPECT_NEAR(hit.range_m, 9.75, 1e-9);
  EXPECT_FALSE(sut.cast({20.0, 30.0, 2.5}, {1.0, 0.0, 0.0}, kFar_m, 0, hit));
}

TEST(World, MeetsFlatGroundWhereTheRayGoesBelowIt) {
  World sut = flat_world(1);
  sut.build();
  Hit hit;

  const bool met = sut.cast({30.0, 30.0, 1.0}, Eigen::Vector3d(3.0, 0.0, -1.0).normalized(), kFar_m, 0, hit);

  ASSERT_TRUE(met);
  EXPECT_NEAR(hit.range_m, std::sqrt(10.0), 1e-5);
  EXPECT_NEAR(hit.cos_incidence, 1.0 / std::sqrt(10.0), 1e-5);
}

TEST(World, MeetsNothingBeyondTheGivenRange) {
  World sut = flat_world(1);
  sut.add(OrientedBox{{30.0, 30.0, 1.0}, {1.0, 1.0, 1.0}});
  sut.build();
  Hit hit;

  EXPECT_TRUE(sut.cast({20.0, 30.0, 1.0}, {1.0, 0.0, 0.0}, 9.1, 0, hit));
  EXPECT_FALSE(sut.cast({20.0, 30.0, 1.0}, {1.0, 0.0, 0.0}, 8.9, 0, hit));
}

TEST(World, LetsLeavesStopARayByItsNumberTheSameWayEachTime) {
  World sut = flat_world(5);
  sut.add(Crown{{30.0, 30.0, 3.0}, 2.0, 1.2});
  sut.build();
  int stopped = 0;
  double depth_sum_m = 0.0;
  for (std::uint64_t ray = 0; ray < 4000; ++ray) {
    Hit first;
    Hit second;
    const bool met = sut.cast({20.0, 30.0, 3.0}, {1.0, 0.0, 0.0}, kFar_m, ray, first);

    ASSERT_EQ(sut.cast({20.0, 30.0, 3.0}, {1.0, 0.0, 0.0}, kFar_m, ray, second), met);
    if (met) {
      ASSERT_EQ(first.range_m, second.range_m);
      ASSERT_GE(first.range_m, 8.0);
      ASSERT_LE(first.range_m, 12.0);
      depth_sum_m += first.range_m - 8.0;
      ++stopped;
    }
  }
  // Four metres of leaves at a mean free path of 1.2 m stop 1 − exp(−4/1.2) of the rays.
  EXPECT_NEAR(stopped / 4000.0, 1.0 - std::exp(-4.0 / 1.2), 0.01);
  EXPECT_NEAR(depth_sum_m / stopped, 1.2 - 4.0 / (std::exp(4.0 / 1.2) - 1.0), 0.06);
}

TEST(Town, IsAnotherOneForAnotherSeedAndTheSameForTheSame) {
  const Town sut(3);
  const Town same(3);
  const Town other(4);
  RayGenerator rays(sut.world(), 3);
  int same_as_other = 0;
  for (std::uint64_t ray = 0; ray < 500; ++ray) {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;
    rays.next(origin, direction);
    Hit a;
    Hit b;
    Hit c;
    const bool met = sut.world().cast(origin, direction, kFar_m, ray, a);

    ASSERT_EQ(same.world().cast(origin, direction, kFar_m, ray, b), met);
    ASSERT_EQ(a.range_m, b.range_m);
    same_as_other += other.world().cast(origin, direction, kFar_m, ray, c) == met && a.range_m == c.range_m ? 1 : 0;
  }
  EXPECT_LT(same_as_other, 250);
}

TEST(Town, KeepsItsTourOnTheRoadAndClearOfEverything) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Town sut(seed);
    constexpr double kHeight_m = 0.45;

    const Motion motion = sut.tour(120.0, 1.6, 3.0, kHeight_m);

    for (double t = 0.0; t < motion.duration_s(); t += 0.5) {
      const Eigen::Vector3d p = motion.pose_at(t).translation();
      EXPECT_NEAR(p.z() - sut.world().ground(p.x(), p.y()), kHeight_m, 0.12) << "seed " << seed << " at " << t << " s";
      for (int i = 0; i < 12; ++i) {
        Hit hit;
        const double azimuth = i * M_PI / 6.0;
        EXPECT_FALSE(sut.world().cast(p, {std::cos(azimuth), std::sin(azimuth), 0.0}, 0.6, 0, hit))
            << "seed " << seed << " at " << t << " s";
      }
    }
  }
}

}  // namespace
}  // namespace slamd::simulate
