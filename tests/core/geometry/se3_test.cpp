#include "core/geometry/se3.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/so3.hpp"

namespace slamd::geometry {
namespace {

Se3 random_transform(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  return {so3_exp({normal(engine), normal(engine), normal(engine)}),
          10.0 * Eigen::Vector3d(normal(engine), normal(engine), normal(engine))};
}

TEST(Se3, ProductAppliesTheRightFactorFirst) {
  std::mt19937_64 engine(1);
  for (int i = 0; i < 100; ++i) {
    const Se3 T_a_b = random_transform(engine);
    const Se3 T_b_c = random_transform(engine);
    const Eigen::Vector3d p_c(1.0, -2.0, 3.0);

    EXPECT_LT(((T_a_b * T_b_c) * p_c - T_a_b * (T_b_c * p_c)).norm(), 1e-12);
    EXPECT_LT((T_a_b.inverse() * (T_a_b * p_c) - p_c).norm(), 1e-12);
  }
}

TEST(Se3, BoxminusInvertsBoxplus) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    const Se3 T = random_transform(engine);
    Vector6d delta;
    for (double& value : delta) {
      value = uniform(engine);
    }

    EXPECT_LT((boxminus(boxplus(T, delta), T) - delta).norm(), 1e-10);
  }
}

TEST(Se3, PerturbationMovesInOuterAxesAndTurnsInInnerAxes) {
  const Se3 T(rotation_from_rpy({0.0, 0.0, M_PI_2}), Eigen::Vector3d::Zero());
  Vector6d delta = Vector6d::Zero();
  delta(0) = 1.0;
  delta(3) = 0.1;

  const Se3 moved = boxplus(T, delta);

  EXPECT_LT((moved.translation() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((moved.rotation() - T.rotation() * so3_exp({0.1, 0.0, 0.0})).norm(), 1e-12);
}

TEST(Se3, InterpolationMeetsBothEndsAndTheMiddle) {
  const Se3 a;
  const Se3 b(so3_exp({0.0, 0.0, 1.0}), Eigen::Vector3d(2.0, 0.0, 0.0));

  EXPECT_LT(boxminus(interpolate(a, b, 0.0), a).norm(), 1e-12);
  EXPECT_LT(boxminus(interpolate(a, b, 1.0), b).norm(), 1e-12);
  EXPECT_NEAR(angle_between(interpolate(a, b, 0.5).rotation(), a.rotation()), 0.5, 1e-12);
}

}  // namespace
}  // namespace slamd::geometry
