#include "core/evaluation/errors.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

#include "core/geometry/so3.hpp"

namespace slamd::evaluation {
namespace {

using geometry::Se3;

/// Draws worlds from one seed: what is shrunk towards zero would be a line.
class Draw {
 public:
  explicit Draw(std::uint32_t seed) : random_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  Se3 rotated(double angle_rad, double distance_m) {
    const auto angle = [&] {
      return between(-angle_rad, angle_rad);
    };
    const auto distance = [&] {
      return between(-distance_m, distance_m);
    };
    const Eigen::Vector3d rpy(angle(), angle(), angle());
    return {geometry::rotation_from_rpy(rpy), {distance(), distance(), distance()}};
  }

 private:
  std::mt19937 random_;
};

/// Pairs with small errors on a path that is no line.
std::vector<PosePair> any_pairs(Draw& draw) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 20; ++i) {
    const Se3 T = draw.rotated(1.5, 50.0);
    pairs.push_back({Stamp{} + std::chrono::seconds(i), T, T * draw.rotated(0.1, 1.0)});
  }
  return pairs;
}

double ape_rmse(const std::vector<PosePair>& pairs, Alignment alignment) {
  return statistics_of(ape_translation_m(pairs, align(pairs, alignment))).rmse;
}

/// A line along x whose estimate lies along y.
std::vector<PosePair> straight_pairs() {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 5; ++i) {
    pairs.push_back({Stamp{} + std::chrono::seconds(i),
                     {Eigen::Matrix3d::Identity(), {1.0 * i, 0, 0}},
                     {geometry::rotation_from_rpy({0, 0, 0.5 * M_PI}), {0, 1.0 * i, 0}}});
  }
  return pairs;
}

TEST(StatisticsOf, MatchesAHandCalculation) {
  const Statistics sut = statistics_of({4.0, 1.0, 3.0, 2.0});

  EXPECT_DOUBLE_EQ(sut.mean, 2.5);
  EXPECT_DOUBLE_EQ(sut.median, 2.5);
  EXPECT_DOUBLE_EQ(sut.std, std::sqrt(1.25));  // of the population
  EXPECT_DOUBLE_EQ(sut.sse, 30.0);
  EXPECT_DOUBLE_EQ(sut.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(sut.min, 1.0);
  EXPECT_DOUBLE_EQ(sut.max, 4.0);
}

TEST(StatisticsOf, IsAllZeroForNoErrors) {
  EXPECT_EQ(statistics_of({}).count, 0U);
}

RC_GTEST_PROP(Ape, VanishesForASimilarityOfTheReference, (std::uint32_t seed)) {
  Draw draw(seed);
  const Se3 moved = draw.rotated(1.5, 50.0);
  const double scale = draw.between(0.5, 2.0);
  std::vector<PosePair> pairs = any_pairs(draw);
  for (PosePair& pair : pairs) {
    pair.estimate = {
        moved.rotation() * pair.reference.rotation(),
        scale * (moved.rotation() * pair.reference.translation()) + moved.translation()};
  }
  const Similarity sut = align(pairs, Alignment::kSim3);

  RC_ASSERT(std::abs(sut.scale - 1.0 / scale) < 1e-9);
  RC_ASSERT(statistics_of(ape_translation_m(pairs, sut)).max < 1e-9);
  RC_ASSERT(statistics_of(ape_rotation_rad(pairs, sut)).max < 1e-6);
}

RC_GTEST_PROP(Ape, DoesNotDependOnWhereTheEstimateBegan, (std::uint32_t seed)) {
  Draw draw(seed);
  const Se3 moved = draw.rotated(1.5, 50.0);
  const std::vector<PosePair> pairs = any_pairs(draw);
  std::vector<PosePair> elsewhere = pairs;
  for (PosePair& pair : elsewhere) {
    pair.estimate = moved * pair.estimate;
  }

  RC_ASSERT(std::abs(ape_rmse(pairs, Alignment::kSe3) - ape_rmse(elsewhere, Alignment::kSe3)) <
            1e-9);
}

RC_GTEST_PROP(Ape, IsNeverLargerWithMoreFreedom, (std::uint32_t seed)) {
  Draw draw(seed);
  const std::vector<PosePair> pairs = any_pairs(draw);

  RC_ASSERT(ape_rmse(pairs, Alignment::kSim3) <= ape_rmse(pairs, Alignment::kSe3) + 1e-12);
  RC_ASSERT(ape_rmse(pairs, Alignment::kSe3) <= ape_rmse(pairs, Alignment::kYaw) + 1e-12);
  RC_ASSERT(ape_rmse(pairs, Alignment::kYaw) <= ape_rmse(pairs, Alignment::kNone) + 1e-12);
}

RC_GTEST_PROP(Rpe, DoesNotDependOnEitherWorld, (std::uint32_t seed)) {
  Draw draw(seed);
  const Se3 a = draw.rotated(1.5, 50.0);
  const Se3 b = draw.rotated(1.5, 50.0);
  const std::vector<PosePair> pairs = any_pairs(draw);
  std::vector<PosePair> elsewhere = pairs;
  for (PosePair& pair : elsewhere) {
    pair = {pair.stamp, a * pair.reference, b * pair.estimate};
  }
  const auto indices = select_pairs(pairs, {});

  const auto here = statistics_of(rpe(pairs, indices).translation_m);
  const auto there = statistics_of(rpe(elsewhere, indices).translation_m);

  RC_ASSERT(std::abs(here.rmse - there.rmse) < 1e-9);
}

TEST(Align, RefusesALineForSe3AndSim3) {
  EXPECT_THROW(align(straight_pairs(), Alignment::kSe3), std::invalid_argument);
  EXPECT_THROW(align(straight_pairs(), Alignment::kSim3), std::invalid_argument);
}

TEST(Align, TurnsALineByYaw) {
  const auto pairs = straight_pairs();
  const Similarity sut = align(pairs, Alignment::kYaw);

  EXPECT_NEAR(statistics_of(ape_translation_m(pairs, sut)).max, 0.0, 1e-12);
  EXPECT_NEAR(statistics_of(ape_rotation_rad(pairs, sut)).max, 0.0, 1e-7);
}

TEST(Align, RefusesNoPoses) {
  EXPECT_THROW(align({}, Alignment::kNone), std::invalid_argument);
}

TEST(RpeDistance, IsByHowMuchADistanceIsWrong) {
  std::vector<PosePair> pairs = straight_pairs();
  pairs[4].estimate.translation() = {3.0, 4.5, 0.0};

  const auto sut = rpe_distance_m(pairs, std::vector<IndexPair>{{0, 2}, {0, 4}});

  EXPECT_NEAR(sut[0], 0.0, 1e-12);
  EXPECT_NEAR(sut[1], std::hypot(3.0, 4.5) - 4.0, 1e-12);
}

TEST(SelectPairs, FindsNoneInTooShortAPath) {
  const auto pairs = straight_pairs();

  EXPECT_TRUE(select_pairs(pairs, {.delta = 10.0, .unit = DeltaUnit::kFrames}).empty());
  EXPECT_TRUE(select_pairs(pairs, {.delta = 10.0, .unit = DeltaUnit::kMetres}).empty());
  EXPECT_TRUE(
      select_pairs(pairs, {.delta = 10.0, .unit = DeltaUnit::kMetres, .all_pairs = true}).empty());
  EXPECT_TRUE(select_pairs({}, {.delta = 1.0, .unit = DeltaUnit::kRadians}).empty());
}

TEST(Tilt, IsTheAngleOfTheVerticalsWhateverTheYaw) {
  std::vector<PosePair> pairs;
  const Se3 tilted(
      geometry::rotation_from_rpy({0.03, 0.0, 0.0}) * geometry::rotation_from_rpy({0, 0, 1.2}),
      {5, 6, 7});
  for (int i = 0; i < 10; ++i) {
    const Se3 T(geometry::rotation_from_rpy({0, 0, 0.5 * i}), {std::cos(i), std::sin(2 * i), 0.0});
    pairs.push_back({Stamp{} + std::chrono::seconds(i), T, tilted * T});
  }

  const Statistics sut = statistics_of(tilt_rad(pairs));

  EXPECT_NEAR(sut.min, 0.03, 1e-9);
  EXPECT_NEAR(sut.max, 0.03, 1e-9);
}

TEST(EndDrift, IsTheErrorOfTheWholeDisplacement) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 5; ++i) {
    const Se3 T(Eigen::Matrix3d::Identity(), {1.0 * i, 0.0, 0.0});
    pairs.push_back({Stamp{} + std::chrono::seconds(i), T, T});
  }
  pairs.back().estimate.translation() += Eigen::Vector3d(0.3, 0.0, 0.4);

  EXPECT_NEAR(end_drift_m(pairs, Similarity{}), 0.5, 1e-12);
}

TEST(KittiSegments, FindsNoneInAShortDrive) {
  EXPECT_EQ(kitti_segments(straight_pairs()).segments, 0U);
}

}  // namespace
}  // namespace slamd::evaluation
