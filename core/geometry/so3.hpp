#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace slamd::geometry {

/// Returns the skew-symmetric matrix of v: skew(v) * w = v × w.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Maps a rotation vector to a rotation matrix (Rodrigues). Units: rad.
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi);

/// Maps a rotation matrix to its rotation vector, |phi| ≤ π; so3_exp's inverse. Units: rad.
Eigen::Vector3d so3_log(const Eigen::Matrix3d& R);

/// Returns the right Jacobian of SO(3): Exp(phi + d) ≈ Exp(phi)·Exp(Jr(phi)·d).
/// Source: Sola et al., "A micro Lie theory", Eq. (143).
Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& phi);

/// Returns the inverse of the right Jacobian: Log(Exp(phi)·Exp(d)) ≈ phi + Jr⁻¹(phi)·d. |phi| < π.
Eigen::Matrix3d so3_right_jacobian_inverse(const Eigen::Vector3d& phi);

/// Returns the nearest rotation matrix (removes what rounding adds over many products).
Eigen::Matrix3d orthonormalized(const Eigen::Matrix3d& R);

/// Returns the smallest rotation that takes the direction of `from` to that of `to`; opposite ones are half a turn about some axis
/// across them. Neither may be zero. (Eigen's FromTwoVectors compiles a singular value decomposition wherever it is named.)
Eigen::Matrix3d rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Returns Rz(yaw)·Ry(pitch)·Rx(roll), the order of the configuration's rpy_deg. Units: rad.
Eigen::Matrix3d rotation_from_rpy(const Eigen::Vector3d& rpy_rad);

/// Returns roll, pitch, yaw with R = Rz(yaw)·Ry(pitch)·Rx(roll), |pitch| ≤ π/2. Units: rad.
Eigen::Vector3d rpy_from_rotation(const Eigen::Matrix3d& R);

}  // namespace slamd::geometry
