// Figures to 1e-9 against expected.py, which computes them in numpy from evo's formulas, on its
// own.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/evaluation/errors.hpp"
#include "core/geometry/so3.hpp"

namespace slamd::evaluation {
namespace {

constexpr double kNear = 1e-9;

Eigen::Matrix3d turn(double roll, double pitch, double yaw) {
  return geometry::rotation_from_rpy({roll, pitch, yaw});
}

std::vector<PosePair> wavy_pairs() {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d p(3.0 * std::cos(0.2 * i), 2.0 * std::sin(0.3 * i), 0.1 * i);
    const Eigen::Matrix3d R = turn(0.05 * std::cos(i), 0.1 * std::sin(i), 0.2 * i);
    const Eigen::Vector3d error(std::sin(5 * i), std::cos(7 * i), std::sin(3 * i));
    const Eigen::Vector3d q =
        1.02 * (turn(0, 0, 0.3) * p) + Eigen::Vector3d(1, 2, 3) + 0.05 * error;
    const Eigen::Matrix3d S = turn(0, 0, 0.3) * R * turn(0.02 * std::sin(2 * i), 0, 0) *
                              turn(0, 0.02 * std::cos(3 * i), 0);
    pairs.push_back({Stamp{} + std::chrono::milliseconds(100 * i), {R, p}, {S, q}});
  }
  return pairs;
}

struct Expected {
  std::size_t count;
  double rmse, mean, median, std, min, max, sse;
};

void expect(const std::vector<double>& errors, const Expected& expected) {
  const Statistics sut = statistics_of(errors);
  EXPECT_EQ(sut.count, expected.count);
  EXPECT_NEAR(sut.rmse, expected.rmse, kNear);
  EXPECT_NEAR(sut.mean, expected.mean, kNear);
  EXPECT_NEAR(sut.median, expected.median, kNear);
  EXPECT_NEAR(sut.std, expected.std, kNear);
  EXPECT_NEAR(sut.min, expected.min, kNear);
  EXPECT_NEAR(sut.max, expected.max, kNear);
  EXPECT_NEAR(sut.sse, expected.sse, 1e-8);
}

void expect_rmse(const std::vector<double>& errors, std::size_t count, double rmse) {
  const Statistics sut = statistics_of(errors);
  EXPECT_EQ(sut.count, count);
  EXPECT_NEAR(sut.rmse, rmse, kNear);
}

TEST(Ape, MatchesEvoWithoutAlignment) {
  const auto pairs = wavy_pairs();
  const Similarity none;

  expect(ape_translation_m(pairs, none),
         {40,
          3.910912008009,
          3.899516247450,
          3.836659678076,
          0.298338348629,
          3.507895425664,
          4.446737452994,
          611.809309375676});
  expect(ape_rotation_rad(pairs, none),
         {40,
          0.300606201813,
          0.300604272179,
          0.300765857882,
          0.001077087041,
          0.298903875395,
          0.302357228777,
          3.614563542739});
  expect_rmse(ape_full(pairs, none), 40, 3.933777318342);
}

TEST(Ape, MatchesEvoAlignedBySe3) {
  const auto pairs = wavy_pairs();
  const Similarity se3 = align(pairs, Alignment::kSe3);

  expect(ape_translation_m(pairs, se3),
         {40,
          0.082002277117,
          0.076933268064,
          0.080332702834,
          0.028383898912,
          0.009286694288,
          0.119522292413,
          0.268974938097});
  expect(ape_rotation_rad(pairs, se3),
         {40,
          0.019543520565,
          0.018643721173,
          0.018852873275,
          0.005861813447,
          0.001558822806,
          0.027186729456,
          0.015277967842});
  expect(ape_full(pairs, se3),
         {40,
          0.086534625758,
          0.082863833622,
          0.085311491120,
          0.024936449881,
          0.028313341195,
          0.122034787338,
          0.299529658205});
}

TEST(Ape, MatchesEvoAlignedBySim3) {
  const auto pairs = wavy_pairs();
  const Similarity sim3 = align(pairs, Alignment::kSim3);

  expect(ape_translation_m(pairs, sim3),
         {40,
          0.060593890687,
          0.059127659881,
          0.060520180697,
          0.013249129238,
          0.026900250889,
          0.079032452589,
          0.146864783544});
  expect_rmse(ape_full(pairs, sim3), 40, 0.066599456389);
}

TEST(Ape, MatchesEvoAlignedByTheFirstTenPoses) {
  const auto pairs = wavy_pairs();
  const Similarity se3 = align(pairs, Alignment::kSe3, 10);

  expect_rmse(ape_translation_m(pairs, se3), 40, 0.102052411254);
  expect_rmse(ape_rotation_rad(pairs, se3), 40, 0.021884028277);
}

TEST(Ape, MatchesASearchForTheBestYaw) {
  const auto pairs = wavy_pairs();
  const Similarity yaw = align(pairs, Alignment::kYaw);

  expect_rmse(ape_translation_m(pairs, yaw), 40, 0.082040723609);
  expect_rmse(ape_rotation_rad(pairs, yaw), 40, 0.019527722908);
}

TEST(Ape, MatchesEvoAlignedByTheOrigin) {
  const auto pairs = wavy_pairs();
  const Similarity origin = align(pairs, Alignment::kOrigin);

  expect_rmse(ape_translation_m(pairs, origin), 40, 0.149093016606);
  expect_rmse(ape_rotation_rad(pairs, origin), 40, 0.027556933961);
}

struct RpeCase {
  PairRule rule;
  std::size_t count;
  double translation_rmse;
  double rotation_rmse;
};

PairRule rule(double delta, DeltaUnit unit, bool all_pairs, bool from_reference = false) {
  return {.delta = delta, .unit = unit, .all_pairs = all_pairs, .from_reference = from_reference};
}

TEST(Rpe, MatchesEvoForEveryWayOfChoosingPairs) {
  const auto pairs = wavy_pairs();
  const double angle = 30.0 * M_PI / 180.0;
  const RpeCase cases[] = {
      {rule(1, DeltaUnit::kFrames, false), 39, 0.090147001616, 0.035638709538},
      {rule(3, DeltaUnit::kFrames, false), 13, 0.122903246401, 0.026510880718},
      {rule(3, DeltaUnit::kFrames, true), 37, 0.121963473287, 0.026981529798},
      {rule(2, DeltaUnit::kMetres, false), 8, 0.106458196089, 0.028641261688},
      {rule(2, DeltaUnit::kMetres, false, true), 8, 0.106458196089, 0.028641261688},
      {rule(2, DeltaUnit::kMetres, true), 18, 0.099065723119, 0.023199000451},
      {rule(angle, DeltaUnit::kRadians, false), 13, 0.122903246401, 0.026510880718},
      {rule(angle, DeltaUnit::kRadians, true), 17, 0.119597340431, 0.024596600739},
  };
  for (const RpeCase& expected : cases) {
    SCOPED_TRACE(&expected - cases);
    const RelativeErrors sut = rpe(pairs, select_pairs(pairs, expected.rule));

    expect_rmse(sut.translation_m, expected.count, expected.translation_rmse);
    expect_rmse(sut.rotation_rad, expected.count, expected.rotation_rmse);
  }
}

TEST(SelectPairs, BeginsByMetresAtTheFirstPushNotAtZero) {
  const auto sut = select_pairs(wavy_pairs(), rule(2, DeltaUnit::kMetres, false));

  ASSERT_GE(sut.size(), 2U);
  EXPECT_EQ(sut[0].first, 4U);
  EXPECT_EQ(sut[0].second, 8U);
  EXPECT_EQ(sut[1].second, 11U);
}

TEST(SelectPairs, BeginsByAngleAtZero) {
  const auto sut =
      select_pairs(wavy_pairs(), rule(30.0 * M_PI / 180.0, DeltaUnit::kRadians, false));

  ASSERT_FALSE(sut.empty());
  EXPECT_EQ(sut[0].first, 0U);
  EXPECT_EQ(sut[0].second, 3U);
}

TEST(SelectPairs, TakesStepsOfExactlyDelta) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 30; ++i) {
    const geometry::Se3 T(Eigen::Matrix3d::Identity(), {1e6 + 0.125 * i, 0.0, 0.0});
    pairs.push_back({Stamp{} + std::chrono::seconds(i), T, T});
  }

  const auto sut = select_pairs(pairs, rule(0.125, DeltaUnit::kMetres, false));

  EXPECT_EQ(sut.size(), 28U);
}

TEST(KittiSegments, MatchesTheDevkitsRules) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d p(1.25 * i, 40.0 * std::sin(0.01 * i), 0.0);
    pairs.push_back({Stamp{} + std::chrono::milliseconds(100 * i),
                     {turn(0, 0, 0.002 * i), p},
                     {turn(0, 0, 0.0021 * i) * turn(0, 0.001 * std::sin(0.1 * i), 0), 1.01 * p}});
  }

  const KittiErrors sut = kitti_segments(pairs);

  EXPECT_EQ(sut.segments, 85U);
  EXPECT_NEAR(sut.translation, 0.016515608184121, 1e-12);
  EXPECT_NEAR(sut.rotation_radpm, 0.000078791471544, 1e-12);
}

}  // namespace
}  // namespace slamd::evaluation
