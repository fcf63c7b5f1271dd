#include "core/graph/pairwise_consistency.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "random_poses.hpp"

namespace slamd::graph {
namespace {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

constexpr std::size_t kRoundKeyframes = 60;

Matrix6d step_covariance() {
  Vector6d d;
  d << 1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-5;
  return d.asDiagonal();
}

Matrix6d loop_covariance() {
  Vector6d d;
  d << 4e-4, 4e-4, 4e-4, 1e-5, 1e-5, 1e-5;
  return d.asDiagonal();
}

Vector6d drawn(Draw& draw, const Matrix6d& covariance) {
  Vector6d z;
  for (double& value : z) {
    value = draw.normal();
  }
  return covariance.llt().matrixL() * z;
}

/// A round of 30 m driven twice, so that keyframe k + 30 stands where k stood.
struct Round {
  std::vector<Se3> T_world_base;
  OdometryChain chain{kRoundKeyframes};

  explicit Round(Draw& draw) {
    const Se3 step(geometry::so3_exp({0.0, 0.0, 2.0 * M_PI / 30.0}), Eigen::Vector3d(1.0, 0.0, 0.0));
    Se3 T_odom_base;
    T_world_base.emplace_back();
    chain.push_back(T_odom_base, Matrix6d::Zero());
    for (std::size_t i = 1; i < kRoundKeyframes; ++i) {
      T_world_base.push_back(T_world_base.back() * step);
      T_odom_base = T_odom_base * boxplus(step, drawn(draw, step_covariance()));
      chain.push_back(T_odom_base, step_covariance());
    }
  }

  ChainLoop loop(Draw& draw, std::size_t i, std::size_t j) const {
    return {i, j, {boxplus(T_world_base[i].inverse() * T_world_base[j], drawn(draw, loop_covariance())), loop_covariance()}};
  }
};

TEST(PairwiseConsistency, IsChiSquaredOfSixForTrueLoops) {
  Draw draw(1);
  double by_odometry = 0.0;
  double by_pair = 0.0;
  constexpr int kDraws = 2'000;
  for (int n = 0; n < kDraws; ++n) {
    const Round round(draw);
    by_odometry += odometry_cycle(round.chain, round.loop(draw, 5, 36)).chi_squared / kDraws;
    by_pair += pair_cycle(round.chain, round.loop(draw, 5, 36), round.loop(draw, 12, 41)).chi_squared / kDraws;
  }

  EXPECT_NEAR(by_odometry, 6.0, 0.4);  // the mean of χ²₆; √(12/2000) is 0.08, the rest is linearisation
  EXPECT_NEAR(by_pair, 6.0, 0.4);
}

TEST(PairwiseConsistency, DoesNotMindTheOrderOfTheTwo) {
  Draw draw(2);
  const Round round(draw);
  const ChainLoop a = round.loop(draw, 5, 36);
  const ChainLoop b = round.loop(draw, 12, 41);

  const double one_way = pair_cycle(round.chain, a, b).chi_squared;

  EXPECT_NEAR(pair_cycle(round.chain, b, a).chi_squared, one_way, 0.02 * one_way);
}

TEST(PairwiseConsistency, ContradictsALoopThatIsOffByAMetre) {
  Draw draw(3);
  const Round round(draw);
  ChainLoop wrong = round.loop(draw, 12, 41);
  wrong.motion.T_a_b.translation().x() += 1.0;

  EXPECT_GT(pair_cycle(round.chain, round.loop(draw, 10, 40), wrong).chi_squared, 100.0);
}

TEST(PairwiseConsistency, SaysLessTheLongerTheWayBetweenTheLoops) {
  Draw draw(4);
  const Round round(draw);
  const ChainLoop sut = round.loop(draw, 2, 32);

  const double near = pair_cycle(round.chain, sut, round.loop(draw, 3, 33)).position_std_m;
  const double far = pair_cycle(round.chain, sut, round.loop(draw, 25, 55)).position_std_m;

  EXPECT_LT(near, 0.1);
  EXPECT_GT(far, 1.5 * near);
}

}  // namespace
}  // namespace slamd::graph
