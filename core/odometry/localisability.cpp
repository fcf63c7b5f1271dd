#include "core/odometry/localisability.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace slamd::odometry {

namespace {

using registration::Constraint;

constexpr double kWeakTurnShare = 0.01;  // of the information on the turns

Eigen::Matrix3d marginal(const Eigen::Matrix3d& own, const Eigen::Matrix3d& cross, const Eigen::Matrix3d& other) {
  const double damping = 1e-9 * other.trace() + 1e-12;
  const Eigen::Matrix3d damped = other + damping * Eigen::Matrix3d::Identity();
  return own - cross * damped.ldlt().solve(cross.transpose());
}

/// The eigenvectors with less than a share of the whole.
registration::WeakDirections weak_eigenvectors(const Eigen::Matrix3d& information, double share) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(information);
  registration::WeakDirections weak;
  for (int i = 0; i < 3; ++i) {
    if (solver.eigenvalues()[i] < share * solver.eigenvalues().sum()) {
      weak.odom[weak.count++] = solver.eigenvectors().col(i);
    }
  }
  return weak;
}

std::uint8_t axes_of(const registration::WeakDirections& weak, const Eigen::Matrix3d& R_frame_odom) {
  std::uint8_t bits = 0;
  for (std::size_t i = 0; i < weak.count; ++i) {
    const Eigen::Vector3d direction = R_frame_odom * weak.odom[i];
    for (int axis = 0; axis < 3; ++axis) {
      bits = static_cast<std::uint8_t>(bits | (std::abs(direction[axis]) > 0.5 ? 1U << axis : 0U));
    }
  }
  return bits;
}

/// Part of the information that comes from surfaces which truly face a direction.
double trusted_part(std::span<const Constraint> constraints, const geometry::Se3& T_odom_imu, double kernel_m,
                    const Eigen::Vector3d& direction) {
  const Eigen::Matrix3f R = T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = T_odom_imu.translation().cast<float>();
  const auto inverse_kernel = static_cast<float>(1.0 / kernel_m);
  double trusted = 0.0;
  double all = 0.0;
  for (const Constraint& constraint : constraints) {
    const float r = inverse_kernel * (constraint.n_odom.dot(R * constraint.p_imu + t) + constraint.d_m);
    const auto weight = static_cast<double>(constraint.inverse_variance / (1.0F + r * r));
    const double along = registration::trusted_along(constraint, direction);
    all += weight;
    trusted += weight * along * along;
  }
  return all > 0.0 ? trusted / all : 0.0;
}

}  // namespace

Localisability localisability_of(std::span<const Constraint> constraints,
                                 const geometry::Matrix6d& information,
                                 const geometry::Se3& T_odom_imu,
                                 double kernel_m,
                                 double share) {
  const Eigen::Matrix3d position = information.topLeftCorner<3, 3>();
  const Eigen::Matrix3d rotation = information.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d cross = information.topRightCorner<3, 3>();
  Localisability result;
  if (position.trace() <= 0.0) {
    return result;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(marginal(position, cross, rotation));
  result.weak_turns = weak_eigenvectors(marginal(rotation, cross.transpose(), position), kWeakTurnShare);
  for (std::size_t i = 0; i < result.weak_turns.count; ++i) {
    result.weak_turns.odom[i] = T_odom_imu.rotation() * result.weak_turns.odom[i];  // δθ is about the imu's own axes
  }
  result.raw_share = std::max(0.0, solver.eigenvalues()[0] / solver.eigenvalues().sum());
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d direction = solver.eigenvectors().col(i);
    // What of it a turn could not explain as well.
    const double seen = direction.dot(position * direction);
    const double held = seen > 0.0 ? std::max(0.0, solver.eigenvalues()[i]) / seen : 0.0;
    const double trusted = held * trusted_part(constraints, T_odom_imu, kernel_m, direction);
    if (i == 0) {
      result.weakest_odom = direction;
      result.share = trusted;
    }
    if (trusted < share) {
      result.weak.odom[result.weak.count++] = direction;
    }
  }
  return result;
}

std::uint8_t weak_axes(const Localisability& localisability, const Eigen::Matrix3d& R_frame_odom) {
  return static_cast<std::uint8_t>(axes_of(localisability.weak, R_frame_odom) |
                                   axes_of(localisability.weak_turns, R_frame_odom) << 3);
}

std::string in_words(std::uint8_t weak_axes_base) {
  constexpr std::array<const char*, 6> kNames{"ahead", "sideways", "height", "roll", "pitch", "heading"};
  std::string words;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if ((weak_axes_base >> i & 1U) != 0) {
      words += (words.empty() ? "" : ", ") + std::string(kNames[i]);
    }
  }
  return words;
}

}  // namespace slamd::odometry
