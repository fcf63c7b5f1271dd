#include "core/graph/odometry_chain.hpp"

#include <gtest/gtest.h>

#include "random_poses.hpp"

namespace slamd::graph {
namespace {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

/// Some motions with full covariances, as if a vehicle had made them.
std::vector<Motion> motions(Draw& draw, std::size_t count) {
  std::vector<Motion> out;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d turn = draw.vector(0.1);
    out.push_back({{geometry::so3_exp(turn), Eigen::Vector3d(1.0 + draw.normal(0.1), draw.normal(0.2), 0.0)},
                   draw.positive<6>(1e-6)});
  }
  return out;
}

OdometryChain chain_of(const std::vector<Motion>& motions) {
  OdometryChain chain(motions.size() + 1);
  Se3 T_odom_base(geometry::so3_exp({0.0, 0.1, 0.4}), Eigen::Vector3d(30.0, -20.0, 1.0));
  chain.push_back(T_odom_base, Matrix6d::Zero());
  for (const Motion& motion : motions) {
    T_odom_base = T_odom_base * motion.T_a_b;
    chain.push_back(T_odom_base, motion.covariance);
  }
  return chain;
}

TEST(OdometryChain, GivesAnyMotionTheCovarianceOfItsStepsComposed) {
  Draw draw(1);
  const std::vector<Motion> steps = motions(draw, 40);
  const OdometryChain sut = chain_of(steps);

  for (std::size_t i : {0U, 7U, 20U}) {
    Motion expected = steps[i];
    for (std::size_t j = i + 1; j < 40; ++j) {
      const Motion found = sut.between(i, j);
      EXPECT_LT(boxminus(found.T_a_b, expected.T_a_b).norm(), 1e-10);
      EXPECT_LT((found.covariance - expected.covariance).norm(), 1e-9 * expected.covariance.norm());
      expected = composed(expected, steps[j]);
    }
  }
}

TEST(OdometryChain, AgreesWithDrawnErrors) {
  Draw draw(2);
  const std::vector<Motion> steps = motions(draw, 20);
  const Motion whole = chain_of(steps).between(0, 20);
  Matrix6d sum = Matrix6d::Zero();
  constexpr int kDraws = 20'000;
  for (int n = 0; n < kDraws; ++n) {
    Se3 T;
    for (const Motion& step : steps) {
      Vector6d z;
      for (double& value : z) {
        value = draw.normal();
      }
      T = T * boxplus(step.T_a_b, step.covariance.llt().matrixL() * z);
    }
    const Vector6d error = boxminus(T, whole.T_a_b);
    sum += error * error.transpose() / kDraws;
  }

  // In the metric of the covariance itself the drawn one is the identity, give or take √(2/n).
  const Matrix6d L = whole.covariance.llt().matrixL();
  const Matrix6d relative = L.inverse() * sum * L.inverse().transpose();
  EXPECT_LT((relative - Matrix6d::Identity()).cwiseAbs().maxCoeff(), 0.05);
}

TEST(OdometryChain, KeepsTheMotionOverAKeyframeThatIsForgotten) {
  Draw draw(3);
  OdometryChain sut = chain_of(motions(draw, 10));
  const Motion before = sut.between(2, 8);

  sut.erase(5);
  sut.erase(5);

  const Motion after = sut.between(2, 6);
  EXPECT_EQ(sut.size(), 9U);
  EXPECT_LT(boxminus(after.T_a_b, before.T_a_b).norm(), 1e-12);
  EXPECT_LT((after.covariance - before.covariance).norm(), 1e-12);
}

TEST(OdometryChain, TurnsAMotionRound) {
  Draw draw(4);
  const Motion a_b{draw.pose(3.0, 0.5), draw.positive<6>(1e-4)};

  const Motion twice = inverse(inverse(a_b));

  EXPECT_LT((twice.covariance - a_b.covariance).norm(), 1e-12);
  // Gone and come back, the errors of both ways add up in the axes of the begin.
  const Motion back = composed(a_b, inverse(a_b));
  const Matrix6d to_a = adjoint(a_b.T_a_b);
  EXPECT_LT((back.covariance - 2.0 * to_a * right_twist_covariance(a_b) * to_a.transpose()).norm(), 1e-10);
}

}  // namespace
}  // namespace slamd::graph
