#include "core/odometry/localisability.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace slamd::odometry {
namespace {

using geometry::Se3;
using registration::Constraint;

constexpr double kKernel_m = 0.05;
constexpr double kShare = 0.012;

/// Points on the walls, the floor and the roof of a straight tunnel along `ahead`, `tilt_rad` of noise in each normal,
/// which the constraints declare; `ends` of them on a wall across it.
std::vector<Constraint> tunnel(const Eigen::Vector3f& ahead, float tilt_rad, int ends) {
  const Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  const Eigen::Vector3f left = up.cross(ahead);
  std::vector<Constraint> constraints;
  for (int i = 0; i < 2000; ++i) {
    const float way = -20.0F + 0.02F * static_cast<float>(i);
    const float side = i % 2 == 0 ? 1.0F : -1.0F;
    const bool wall = i % 4 < 2;
    Constraint constraint;
    const Eigen::Vector3f n = wall ? Eigen::Vector3f(side * left) : Eigen::Vector3f(side * up);
    constraint.n_odom = (n + tilt_rad * (i % 3 == 0 ? 1.0F : -1.0F) * ahead).normalized();
    constraint.tilt_odom = tilt_rad * ahead;
    constraint.p_imu = way * ahead + 3.0F * n + 0.5F * static_cast<float>(i % 5) * (wall ? up : left);
    constraint.d_m = -constraint.n_odom.dot(constraint.p_imu);
    constraints.push_back(constraint);
  }
  for (int i = 0; i < ends; ++i) {
    Constraint constraint;
    constraint.n_odom = ahead;
    constraint.p_imu = 25.0F * ahead + 0.1F * static_cast<float>(i % 30) * left + 0.1F * static_cast<float>(i / 30) * up;
    constraint.d_m = -constraint.n_odom.dot(constraint.p_imu);
    constraints.push_back(constraint);
  }
  return constraints;
}

Localisability judged(const std::vector<Constraint>& constraints) {
  const geometry::Matrix6d information = registration::linearize(constraints, Se3{}, kKernel_m).H;
  return localisability_of(constraints, information, Se3{}, kKernel_m, kShare);
}

std::uint8_t axes_of(const std::vector<Constraint>& constraints) {
  return weak_axes(judged(constraints), Eigen::Matrix3d::Identity());
}

TEST(Localisability, NamesTheAxisAlongATunnel) {
  EXPECT_EQ(axes_of(tunnel(Eigen::Vector3f::UnitX(), 0.0F, 0)) & 7, 0b001);
  EXPECT_EQ(axes_of(tunnel(Eigen::Vector3f::UnitY(), 0.0F, 0)) & 7, 0b010);
}

TEST(Localisability, DoesNotTakeTheNoiseOfNormalsForWallsAcross) {
  const std::vector<Constraint> noisy = tunnel(Eigen::Vector3f::UnitX(), 0.25F, 0);

  const Localisability found = judged(noisy);

  EXPECT_GT(found.raw_share, kShare);
  EXPECT_LT(found.share, kShare);
  EXPECT_GT(std::abs(found.weakest_odom.x()), 0.99);
}

/// What a sensor that looks ahead sees of a tunnel: the left wall farther on than the right one, and the floor.
std::vector<Constraint> tunnel_ahead(float tilt_rad, bool declared) {
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0.0F, tilt_rad);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<Constraint> constraints;
  for (int i = 0; i < 3000; ++i) {
    const bool left = i % 3 == 0;
    const bool right = i % 3 == 1;
    const Eigen::Vector3f n = left ? Eigen::Vector3f::UnitY() : right ? Eigen::Vector3f(-Eigen::Vector3f::UnitY()) : Eigen::Vector3f::UnitZ();
    Constraint constraint;
    constraint.p_imu = left ? Eigen::Vector3f(10.0F + 10.0F * unit(random), 6.0F, 2.0F * unit(random))
                     : right ? Eigen::Vector3f(5.0F + 5.0F * unit(random), -3.0F, 2.0F * unit(random))
                             : Eigen::Vector3f(5.0F + 15.0F * unit(random), 2.0F * unit(random), -1.0F);
    constraint.n_odom = (n + noise(random) * Eigen::Vector3f::UnitX()).normalized();
    constraint.tilt_odom = declared ? Eigen::Vector3f(tilt_rad * Eigen::Vector3f::UnitX()) : Eigen::Vector3f::Zero();
    constraint.d_m = -constraint.n_odom.dot(constraint.p_imu);
    constraints.push_back(constraint);
  }
  return constraints;
}

TEST(Localisability, IsNotTurnedAsideByTheNoiseOfNormals) {
  const auto aside_rad = [](const std::vector<Constraint>& constraints) {
    return std::acos(std::min(1.0, std::abs(judged(constraints).weakest_odom.x())));
  };

  EXPECT_LT(aside_rad(tunnel_ahead(0.2F, true)), 0.03);
  EXPECT_GT(aside_rad(tunnel_ahead(0.2F, false)), 0.06);
}

TEST(Localisability, KeepsToARememberedDirection) {
  const std::vector<Constraint> closed = tunnel(Eigen::Vector3f::UnitX(), 0.1F, 300);
  const geometry::Matrix6d information = registration::linearize(closed, Se3{}, kKernel_m).H;

  const Localisability found =
      localisability_of(closed, information, Se3{}, kKernel_m, kShare, Eigen::Vector3d(Eigen::Vector3d::UnitX()));

  EXPECT_EQ(found.own_weak, 0U);
  ASSERT_EQ(found.weak.count, 1U);
  EXPECT_EQ(found.weak.odom[0], Eigen::Vector3d::UnitX());
  EXPECT_NEAR(found.remembered_share, found.share, 0.5 * found.share);
}

TEST(Localisability, SeesTheWallAtTheEnd) {
  EXPECT_EQ(axes_of(tunnel(Eigen::Vector3f::UnitX(), 0.1F, 300)) & 7, 0);
}

TEST(Localisability, TurnsWithTheFrameThatItIsAskedFor) {
  const Localisability found =
      judged(tunnel(Eigen::Vector3f::UnitX(), 0.0F, 0));
  const Eigen::Matrix3d R_base_odom = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();

  EXPECT_EQ(weak_axes(found, R_base_odom) & 7, 0b010);
}

TEST(Localisability, SaysTheWeakAxesInWords) {
  EXPECT_EQ(in_words(0b000001), "ahead");
  EXPECT_EQ(in_words(0b100010), "sideways, heading");
}

}  // namespace
}  // namespace slamd::odometry
