#include "core/registration/neighbour_fit.hpp"

#include <random>

#include <gtest/gtest.h>

namespace slamd::registration {
namespace {

/// A map of random points, and a walk through it in steps of a given length.
class NeighbourFitTest : public testing::Test {
 protected:
  NeighbourFitTest() : map_(map::VoxelMapConfig{}) {
    std::vector<Eigen::Vector3f> points(20'000);
    for (Eigen::Vector3f& p : points) {
      p = within(6.0F);
    }
    map_.insert(points, 0.0);
  }

  Eigen::Vector3f within(float extent_m) {
    std::uniform_real_distribution<float> uniform(-extent_m, extent_m);
    return {uniform(engine_), uniform(engine_), 0.3F * uniform(engine_)};
  }

  std::mt19937_64 engine_{1};
  map::VoxelMap map_;
};

TEST_F(NeighbourFitTest, GivesTheBitsOfANewLookUpHoweverFarThePointMoves) {
  std::size_t same_neighbours = 0;
  for (const float step_m : {0.0005F, 0.005F, 0.05F, 1.0F}) {
    for (int walk = 0; walk < 500; ++walk) {
      NeighbourFit sut;
      Eigen::Vector3f p = within(7.0F);
      sut.look_up(map_, p, 1.0F);
      for (int i = 0; i < 3; ++i) {
        const map::Neighbours before = sut.neighbours();
        p += within(step_m);
        NeighbourFit expected;
        expected.look_up(map_, p, 1.0F);

        sut.look_up(map_, p, 1.0F);

        ASSERT_EQ(sut.neighbours().count, expected.neighbours().count);
        for (std::size_t n = 0; n < expected.neighbours().count; ++n) {  // what lies beyond holds nothing
          ASSERT_EQ(sut.neighbours().distance_sq_m2[n], expected.neighbours().distance_sq_m2[n]);
          ASSERT_EQ(sut.neighbours().points_odom[n], expected.neighbours().points_odom[n]);
        }
        if (expected.is_full()) {
          ASSERT_EQ(sut.axes().mean, expected.axes().mean);
          ASSERT_EQ(sut.axes().lambda, expected.axes().lambda);
          ASSERT_EQ(sut.axes().vectors, expected.axes().vectors);
        }
        same_neighbours += expected.is_full() && before.points_odom == expected.neighbours().points_odom ? 1 : 0;
      }
    }
  }
  EXPECT_GT(same_neighbours, 2000U);
  EXPECT_LT(same_neighbours, 5000U);
}

TEST_F(NeighbourFitTest, KeepsToWhatItKnowsUntilToldToForget) {
  NeighbourFit sut;
  const Eigen::Vector3f p(0.1F, 0.2F, 0.3F);
  sut.look_up(map_, p, 1.0F);
  ASSERT_TRUE(sut.is_full());
  const map::VoxelMap empty{map::VoxelMapConfig{}};

  sut.look_up(empty, p, 1.0F);
  EXPECT_TRUE(sut.is_full());
  sut.forget();
  sut.look_up(empty, p, 1.0F);

  EXPECT_EQ(sut.neighbours().count, 0U);
}

}  // namespace
}  // namespace slamd::registration
