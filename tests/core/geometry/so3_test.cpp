#include "core/geometry/so3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace slamd::geometry {
namespace {

Eigen::Vector3d random_rotation_vector(std::mt19937_64& engine, double max_angle_rad) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, max_angle_rad);
  Eigen::Vector3d axis(normal(engine), normal(engine), normal(engine));
  return axis.normalized() * uniform(engine);
}

TEST(So3, LogInvertsExpUpToPi) {
  std::mt19937_64 engine(1);
  for (const double max_angle : {1e-9, 1e-5, 1e-3, 1.0, 3.14159}) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d phi = random_rotation_vector(engine, max_angle);

      const Eigen::Vector3d round_trip = so3_log(so3_exp(phi));

      EXPECT_LT((round_trip - phi).norm(), 1e-9 * (1.0 + 1.0 / (3.1416 - phi.norm()))) << phi.transpose();
    }
  }
}

TEST(So3, ExpGivesRotations) {
  std::mt19937_64 engine(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d R = so3_exp(random_rotation_vector(engine, 6.0));

    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
  }
}

TEST(So3, RightJacobianMatchesNumericDerivative) {
  std::mt19937_64 engine(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d phi = random_rotation_vector(engine, 3.0);
    const Eigen::Matrix3d jacobian = so3_right_jacobian(phi);
    constexpr double kStep = 1e-6;

    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector3d numeric =
          (so3_log(so3_exp(phi).transpose() * so3_exp(phi + d)) - so3_log(so3_exp(phi).transpose() * so3_exp(phi - d))) /
          (2.0 * kStep);
      EXPECT_LT((numeric - jacobian.col(axis)).norm(), 1e-7);
    }
    EXPECT_LT((jacobian * so3_right_jacobian_inverse(phi) - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  }
}

TEST(So3, RotationBetweenIsTheSmallestThatTakesOneDirectionToTheOther) {
  std::mt19937_64 engine(5);
  for (const double angle : {0.0, 1e-8, 0.3, 1.6, 3.1, 3.1415926, std::numbers::pi}) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d from = random_rotation_vector(engine, 3.0);
      const Eigen::Vector3d axis = from.unitOrthogonal();
      const Eigen::Vector3d to = 7.0 * (so3_exp(angle * axis) * from);

      const Eigen::Matrix3d sut = rotation_between(from, to);

      EXPECT_LT((sut * from.normalized() - to.normalized()).norm(), 1e-8) << angle;
      EXPECT_LT((sut * sut.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-8) << angle;
      EXPECT_NEAR(so3_log(sut).norm(), angle, 1e-7);
    }
  }
}

TEST(So3, RollPitchYawRoundTrips) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d rpy(2.0 * uniform(engine), uniform(engine), 2.0 * uniform(engine));

    EXPECT_LT((rpy_from_rotation(rotation_from_rpy(rpy)) - rpy).norm(), 1e-9);
  }
}

TEST(So3, RollPitchYawOfARotationThatLooksStraightUpOrDownGivesThatRotation) {
  for (const double pitch : {-M_PI_2, M_PI_2}) {
    const Eigen::Matrix3d R = rotation_from_rpy({0.4, pitch, -1.1});

    EXPECT_LT((rotation_from_rpy(rpy_from_rotation(R)) - R).norm(), 1e-9);
  }
}

TEST(So3, YawTurnsLeft) {
  const Eigen::Vector3d turned = rotation_from_rpy({0.0, 0.0, M_PI_2}) * Eigen::Vector3d::UnitX();

  EXPECT_LT((turned - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

}  // namespace
}  // namespace slamd::geometry
