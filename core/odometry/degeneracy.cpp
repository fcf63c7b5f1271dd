#include "core/odometry/degeneracy.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace slamd::odometry {

namespace {

std::uint8_t weak_bits(const Eigen::Matrix3d& information, double share) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(information);
  const double limit = share * solver.eigenvalues().sum();
  std::uint8_t bits = 0;
  for (int i = 0; i < 3; ++i) {
    if (solver.eigenvalues()[i] >= limit) {
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      // More than a fair share of the direction: a slanted weak direction marks each axis that it moves.
      if (std::abs(solver.eigenvectors()(axis, i)) > 0.5) {
        bits = static_cast<std::uint8_t>(bits | (1U << axis));
      }
    }
  }
  return bits;
}

Eigen::Matrix3d marginal(const Eigen::Matrix3d& own, const Eigen::Matrix3d& cross, const Eigen::Matrix3d& other) {
  const double damping = 1e-9 * other.trace() + 1e-12;
  const Eigen::Matrix3d damped = other + damping * Eigen::Matrix3d::Identity();
  return own - cross * damped.ldlt().solve(cross.transpose());
}

}  // namespace

std::uint8_t weak_axes(const geometry::Matrix6d& information, double share) {
  const Eigen::Matrix3d position = information.topLeftCorner<3, 3>();
  const Eigen::Matrix3d rotation = information.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d cross = information.topRightCorner<3, 3>();
  const std::uint8_t moves = weak_bits(marginal(position, cross, rotation), share);
  const std::uint8_t turns = weak_bits(marginal(rotation, cross.transpose(), position), share);
  return static_cast<std::uint8_t>(moves | (turns << 3));
}

}  // namespace slamd::odometry
