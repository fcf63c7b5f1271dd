#include "core/registration/constraint.hpp"

#include <cmath>

namespace slamd::registration {

NormalEquations linearize(std::span<const Constraint> constraints,
                          const geometry::Se3& T_odom_imu,
                          double kernel_m) {
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
    J.head<3>() = n;
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

}  // namespace slamd::registration
