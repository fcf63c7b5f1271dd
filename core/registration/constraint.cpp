#include "core/registration/constraint.hpp"

#include <cmath>

namespace slamd::registration {

namespace {

/// A normal is believed to face a direction when it does so by more than so many standard deviations of its tilt.
constexpr double kTiltCaution_sq = 6.0 * 6.0;

/// `seen(constraint, n)` is the part of a normal along which its surface may speak.
template <typename Seen>
NormalEquations sum_of(std::span<const Constraint> constraints,
                       const geometry::Se3& T_odom_imu,
                       double kernel_m,
                       Seen&& seen) {
  NormalEquations sum;
  const Eigen::Matrix3d& R = T_odom_imu.rotation();
  const Eigen::Vector3d& t = T_odom_imu.translation();
  const double inverse_kernel_sq = 1.0 / (kernel_m * kernel_m);
  for (const Constraint& constraint : constraints) {
    const Eigen::Vector3d p = constraint.p_imu.cast<double>();
    const Eigen::Vector3d n = constraint.n_odom.cast<double>();
    const double residual = n.dot(R * p + t) + static_cast<double>(constraint.d_m);
    const double scaled_sq = residual * residual * inverse_kernel_sq;
    const double weight = static_cast<double>(constraint.inverse_variance) / (1.0 + scaled_sq);
    geometry::Vector6d J;
    J.head<3>() = seen(constraint, n);
    J.tail<3>() = p.cross(R.transpose() * n);
    const geometry::Vector6d wJ = weight * J;
    sum.H.noalias() += wJ * J.transpose();
    sum.g += residual * wJ;
    sum.cost += static_cast<double>(constraint.inverse_variance) *
                (std::isinf(kernel_m) ? residual * residual : std::log1p(scaled_sq) / inverse_kernel_sq);
    sum.absolute_sum_m += std::abs(residual);
    sum.inliers += scaled_sq < 1.0 ? 1 : 0;
    ++sum.count;
  }
  return sum;
}

}  // namespace

NormalEquations linearize(std::span<const Constraint> constraints,
                          const geometry::Se3& T_odom_imu,
                          double kernel_m) {
  return sum_of(constraints, T_odom_imu, kernel_m, [](const Constraint&, const Eigen::Vector3d& n) { return n; });
}

double trusted_along(const Constraint& constraint, const Eigen::Vector3d& direction_odom) {
  const double along = constraint.n_odom.cast<double>().dot(direction_odom);
  const double tilt = constraint.tilt_odom.cast<double>().dot(direction_odom);
  const double along_sq = along * along;
  return along * along_sq / (along_sq + kTiltCaution_sq * tilt * tilt + 1e-12);
}

NormalEquations linearize_trusted(std::span<const Constraint> constraints,
                                  const geometry::Se3& T_odom_imu,
                                  double kernel_m,
                                  const WeakDirections& weak) {
  return sum_of(constraints, T_odom_imu, kernel_m, [&](const Constraint& constraint, const Eigen::Vector3d& n) {
    Eigen::Vector3d seen = n;
    for (std::size_t i = 0; i < weak.count; ++i) {
      seen += (trusted_along(constraint, weak.odom[i]) - n.dot(weak.odom[i])) * weak.odom[i];
    }
    return seen;
  });
}

}  // namespace slamd::registration
