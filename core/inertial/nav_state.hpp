#pragma once

#include <Eigen/Core>

#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"

namespace slamd::inertial {

/// Standard gravity; the difference to the local value ends up in the accelerometer bias. Units: m/s².
inline constexpr double kGravityMps2 = 9.80665;

/// Number of error states and the place of each block in them (design.md): p, θ, v, b_g, b_a, g on S².
inline constexpr int kErrorStates = 17;
inline constexpr int kPosition = 0;
inline constexpr int kRotation = 3;
inline constexpr int kVelocity = 6;
inline constexpr int kGyroBias = 9;
inline constexpr int kAccelBias = 12;
inline constexpr int kGravity = 15;

using ErrorState = Eigen::Matrix<double, kErrorStates, 1>;
using Covariance = Eigen::Matrix<double, kErrorStates, kErrorStates>;

/// The error states and, as the eighteenth, the wheels' scale (wheel_update.hpp).
inline constexpr int kFilterStates = kErrorStates + 1;

/// How the filter's errors at one time live on in those of a later one: e_later = Φ e + what noise added.
using Transition = Eigen::Matrix<double, kFilterStates, kFilterStates>;

/// What goes with the error states through each propagation, linear in them. Column 0: their covariance with the wheels'
/// scale; the others: the upper rows of a Transition.
using Followers = Eigen::Matrix<double, kErrorStates, 1 + kFilterStates>;

/// Where the imu is and how it moves.
/// Frames: velocity and gravity in odom; biases in imu.  Units: m, m/s, rad/s, m/s².
struct NavState {
  Stamp stamp{};
  geometry::Se3 T_odom_imu;
  Eigen::Vector3d v_odom_imu = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d g_odom = {0.0, 0.0, -kGravityMps2};
};

/// Returns two orthonormal vectors that span the tangent plane of the sphere at g. Shape: 3 × 2.
Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& g);

/// Applies an error state: p + δp, R·Exp(δθ), v + δv, b + δb, Exp(B(g)·δg)·g.
NavState boxplus(const NavState& state, const ErrorState& delta);

/// Returns the error state that takes b to a (to first order in g; exact elsewhere).
ErrorState boxminus(const NavState& a, const NavState& b);

}  // namespace slamd::inertial
