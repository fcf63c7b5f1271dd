#include "core/odometry/localisability.hpp"

#include <gtest/gtest.h>

#include <cmath>
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
