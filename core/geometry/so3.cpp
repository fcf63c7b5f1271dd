#include "core/geometry/so3.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slamd::geometry {

namespace {

/// Below this angle the closed forms lose digits to cancellation and their series are exact to double precision.
constexpr double kSmallAngleRad = 1e-4;

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d S;
  S << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return S;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi) {
  const double angle_sq = phi.squaredNorm();
  const double angle = std::sqrt(angle_sq);
  const bool small = angle < kSmallAngleRad;
  const double a = small ? 1.0 - angle_sq / 6.0 : std::sin(angle) / angle;
  const double b = small ? 0.5 - angle_sq / 24.0 : (1.0 - std::cos(angle)) / angle_sq;
  const Eigen::Matrix3d S = skew(phi);
  return Eigen::Matrix3d::Identity() + a * S + b * S * S;
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& R) {
  // The quaternion's form stays accurate near 0 and near π, where the matrix's trace does not.
  Eigen::Quaterniond q(R);
  q.normalize();
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double w = sign * q.w();
  const double sine = v.norm();
  if (sine < kSmallAngleRad) {
    return (2.0 / w) * (1.0 - sine * sine / (3.0 * w * w)) * v;
  }
  return (2.0 * std::atan2(sine, w) / sine) * v;
}

Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& phi) {
  const double angle_sq = phi.squaredNorm();
  const double angle = std::sqrt(angle_sq);
  const bool small = angle < kSmallAngleRad;
  const double a = small ? 0.5 - angle_sq / 24.0 : (1.0 - std::cos(angle)) / angle_sq;
  const double b = small ? 1.0 / 6.0 - angle_sq / 120.0 : (angle - std::sin(angle)) / (angle_sq * angle);
  const Eigen::Matrix3d S = skew(phi);
  return Eigen::Matrix3d::Identity() - a * S + b * S * S;
}

Eigen::Matrix3d so3_right_jacobian_inverse(const Eigen::Vector3d& phi) {
  const double angle_sq = phi.squaredNorm();
  const double angle = std::sqrt(angle_sq);
  const double c = angle < kSmallAngleRad
                       ? 1.0 / 12.0 + angle_sq / 720.0
                       : 1.0 / angle_sq - (1.0 + std::cos(angle)) / (2.0 * angle * std::sin(angle));
  const Eigen::Matrix3d S = skew(phi);
  return Eigen::Matrix3d::Identity() + 0.5 * S + c * S * S;
}

Eigen::Matrix3d orthonormalized(const Eigen::Matrix3d& R) {
  return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized();
  const Eigen::Vector3d b = to.normalized();
  const double sum = (a + b).norm();  // twice the cosine of half the angle, without the digits that 1 + a·b loses
  if (sum < 1e-9) {
    return Eigen::AngleAxisd(std::numbers::pi, a.unitOrthogonal()).toRotationMatrix();
  }
  Eigen::Quaterniond q;
  q.vec() = a.cross(b) / sum;
  q.w() = 0.5 * sum;
  return q.normalized().toRotationMatrix();
}

Eigen::Matrix3d rotation_from_rpy(const Eigen::Vector3d& rpy_rad) {
  return (Eigen::AngleAxisd(rpy_rad.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy_rad.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy_rad.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Vector3d rpy_from_rotation(const Eigen::Matrix3d& R) {
  const double cosine = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cosine);
  if (cosine < 1e-9) {
    // Looking straight up or down roll and yaw turn about the same axis: all of it is called yaw.
    return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  }
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

}  // namespace slamd::geometry
