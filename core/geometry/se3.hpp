#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace slamd::geometry {

/// A rigid transform. Named T_a_b it takes coordinates in b to coordinates in a: p_a = T_a_b * p_b, so that
/// adjacent frame letters cancel: T_map_base = T_map_odom * T_odom_base.
///
/// The house's one perturbation convention (design.md): p = p⁻ + δp in the axes of the outer frame,
/// R = R⁻·Exp(δθ); order position, then rotation; see boxplus and boxminus.
class Se3 {
 public:
  Se3() = default;
  Se3(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
      : rotation_(rotation), translation_(translation) {}
  Se3(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
      : rotation_(rotation.normalized().toRotationMatrix()), translation_(translation) {}

  const Eigen::Matrix3d& rotation() const { return rotation_; }
  const Eigen::Vector3d& translation() const { return translation_; }
  Eigen::Matrix3d& rotation() { return rotation_; }
  Eigen::Vector3d& translation() { return translation_; }
  Eigen::Quaterniond quaternion() const { return Eigen::Quaterniond(rotation_).normalized(); }

  Se3 inverse() const { return {rotation_.transpose(), -(rotation_.transpose() * translation_)}; }

  Se3 operator*(const Se3& other) const {
    return {rotation_ * other.rotation_, rotation_ * other.translation_ + translation_};
  }

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation_ * p + translation_; }

 private:
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_ = Eigen::Vector3d::Zero();
};

/// (δp, δθ): position in the outer frame's axes, then rotation.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Applies a perturbation: p + δp, R·Exp(δθ). Units: m, rad.
Se3 boxplus(const Se3& T, const Vector6d& delta);

/// Returns the perturbation that takes b to a: boxplus(b, boxminus(a, b)) = a. Units: m, rad.
Vector6d boxminus(const Se3& a, const Se3& b);

/// Interpolates with constant linear velocity (outer frame) and constant angular velocity; ratio 0 gives a, 1 gives b.
Se3 interpolate(const Se3& a, const Se3& b, double ratio);

/// Returns the rotation angle between two orientations. Units: rad.
double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

}  // namespace slamd::geometry
