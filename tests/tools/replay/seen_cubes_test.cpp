#include "tools/replay/seen_cubes.hpp"

#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

namespace slamd::replay {
namespace {

TEST(SeenCubes, AdmitsTheFirstPointOfEachCubeOnBothSidesOfTheOrigin) {
  SeenCubes sut(0.25F);
  std::set<std::tuple<int, int, int>> seen;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate_m(-3.0F, 3.0F);

  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector3f p(coordinate_m(random), coordinate_m(random), coordinate_m(random));
    const auto cube = [](float x_m) { return static_cast<int>(std::floor(4.0F * x_m)); };

    const bool first = seen.emplace(cube(p.x()), cube(p.y()), cube(p.z())).second;
    EXPECT_EQ(sut.admit(p), first) << p.transpose();
  }
  EXPECT_GT(seen.size(), 10'000U);
}

TEST(SeenCubes, TellsCubesApartThatLieFarFromOneAnother) {
  SeenCubes sut(0.125F);

  EXPECT_TRUE(sut.admit({0.0F, 0.0F, 0.0F}));
  EXPECT_TRUE(sut.admit({1.0F, 0.0F, 0.0F}));  // the same place in the next block
  EXPECT_TRUE(sut.admit({0.0F, -5000.0F, 0.0F}));
  EXPECT_FALSE(sut.admit({1.1F, 0.0F, 0.0F}));
}

}  // namespace
}  // namespace slamd::replay
