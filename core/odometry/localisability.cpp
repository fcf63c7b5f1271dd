#include "core/odometry/localisability.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace slamd::odometry {

namespace {

using geometry::Matrix6d;
using registration::Constraint;

constexpr double kWeakTurnShare = 0.01;  // of the information on the turns

/// What a constraint weighs at a pose under the Cauchy kernel.  Units: 1/m².
double weight_of(const Constraint& constraint, const geometry::Se3& T_odom_imu, double kernel_m) {
  const Eigen::Vector3d p_odom = T_odom_imu * constraint.p_imu.cast<double>();
  const double r = (constraint.n_odom.cast<double>().dot(p_odom) + static_cast<double>(constraint.d_m)) / kernel_m;
  return static_cast<double>(constraint.inverse_variance) / (1.0 + r * r);
}

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

/// The information less what the noise of the normals has put into it. Each normal is n + δn, and n nᵀ is larger by δn δnᵀ
/// than it should be: along a tunnel that is more than all its walls say of the axis, and it turns the eigenvectors.
Matrix6d without_tilts(std::span<const Constraint> constraints, const Matrix6d& information, const geometry::Se3& T_odom_imu,
                       double kernel_m) {
  const Eigen::Matrix3d R_imu_odom = T_odom_imu.rotation().transpose();
  Matrix6d result = information;
  for (const Constraint& constraint : constraints) {
    const Eigen::Vector3d tilt = constraint.tilt_odom.cast<double>();
    geometry::Vector6d J;
    J << tilt, constraint.p_imu.cast<double>().cross(R_imu_odom * tilt);
    result.noalias() -= weight_of(constraint, T_odom_imu, kernel_m) * J * J.transpose();
  }
  return result;
}

/// Parts of the information that come from surfaces which truly face each of the directions.
std::array<double, 4> trusted_parts(std::span<const Constraint> constraints, const geometry::Se3& T_odom_imu, double kernel_m,
                                    std::span<const Eigen::Vector3d> directions) {
  std::array<double, 4> trusted{};
  double all = 0.0;
  for (const Constraint& constraint : constraints) {
    const double weight = weight_of(constraint, T_odom_imu, kernel_m);
    all += weight;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const double along = registration::trusted_along(constraint, directions[i]);
      trusted[i] += weight * along * along;
    }
  }
  for (double& part : trusted) {
    part = all > 0.0 ? part / all : 0.0;
  }
  return trusted;
}

}  // namespace

Localisability localisability_of(std::span<const Constraint> constraints,
                                 const geometry::Matrix6d& information,
                                 const geometry::Se3& T_odom_imu,
                                 double kernel_m,
                                 double share,
                                 const std::optional<Eigen::Vector3d>& remembered_odom) {
  const Eigen::Matrix3d position = information.topLeftCorner<3, 3>();
  const Eigen::Matrix3d rotation = information.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d cross = information.topRightCorner<3, 3>();
  Localisability result;
  if (position.trace() <= 0.0) {
    return result;
  }
  const Eigen::Matrix3d held = marginal(position, cross, rotation);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(held, Eigen::EigenvaluesOnly);
  result.raw_share = std::max(0.0, solver.eigenvalues()[0] / solver.eigenvalues().sum());
  const Matrix6d true_information = without_tilts(constraints, information, T_odom_imu, kernel_m);
  solver.computeDirect(marginal(true_information.topLeftCorner<3, 3>(), true_information.topRightCorner<3, 3>(),
                                true_information.bottomRightCorner<3, 3>()));
  result.weak_turns = weak_eigenvectors(marginal(rotation, cross.transpose(), position), kWeakTurnShare);
  for (std::size_t i = 0; i < result.weak_turns.count; ++i) {
    result.weak_turns.odom[i] = T_odom_imu.rotation() * result.weak_turns.odom[i];  // δθ is about the imu's own axes
  }
  std::array<Eigen::Vector3d, 4> directions;
  for (int i = 0; i < 3; ++i) {
    directions[static_cast<std::size_t>(i)] = solver.eigenvectors().col(i);
  }
  const std::size_t count = remembered_odom ? 4 : 3;
  directions[3] = remembered_odom.value_or(Eigen::Vector3d::Zero());
  std::array<double, 4> shares = trusted_parts(constraints, T_odom_imu, kernel_m, std::span(directions).first(count));
  for (std::size_t i = 0; i < count; ++i) {
    // What of it a turn could not explain as well.
    const double seen = directions[i].dot(position * directions[i]);
    shares[i] *= seen > 0.0 ? std::max(0.0, directions[i].dot(held * directions[i])) / seen : 0.0;
  }
  result.weakest_odom = directions[0];
  result.share = shares[0];
  for (std::size_t i = 0; i < 3; ++i) {
    if (shares[i] < share) {
      result.weak.odom[result.weak.count++] = directions[i];
    }
  }
  result.own_weak = result.weak.count;
  if (remembered_odom) {
    result.remembered_share = shares[3];
    Eigen::Vector3d more = *remembered_odom;
    for (std::size_t i = 0; i < result.weak.count; ++i) {
      more -= more.dot(result.weak.odom[i]) * result.weak.odom[i];
    }
    if (result.weak.count < 2 && more.norm() > M_SQRT1_2) {
      result.weak.odom[result.weak.count++] = more.normalized();
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
