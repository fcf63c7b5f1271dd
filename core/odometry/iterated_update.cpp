#include "core/odometry/iterated_update.hpp"

#include <Eigen/Cholesky>

#include "core/geometry/so3.hpp"

namespace slamd::odometry {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;
using inertial::Covariance;
using inertial::ErrorState;
using inertial::NavState;
using registration::NormalEquations;

namespace {

constexpr int kPose = inertial::kPosition;  // the first six error states

/// Moves the whole state to a given pose; the rest follows by its correlation with the pose.
NavState conditioned_on_pose(const NavState& prior, const Covariance& P, const Se3& T_odom_imu) {
  const Vector6d xi = geometry::boxminus(T_odom_imu, prior.T_odom_imu);
  const Matrix6d P_pose = P.block<6, 6>(kPose, kPose);
  const ErrorState delta = P.middleCols<6>(kPose) * P_pose.ldlt().solve(xi);
  NavState state = inertial::boxplus(prior, delta);
  state.T_odom_imu = T_odom_imu;
  return state;
}

/// One Gauss–Newton step of the posterior: ‖x ⊟ x⁻‖²_P⁻¹ + Σ w r². Returns the step; writes its information.
ErrorState posterior_step(const NavState& state,
                          const NavState& prior,
                          const Covariance& P_prior_inverse,
                          const NormalEquations& scan,
                          double share,
                          Covariance& information) {
  const ErrorState error = inertial::boxminus(state, prior);
  Covariance J = Covariance::Identity();
  J.block<3, 3>(inertial::kRotation, inertial::kRotation) =
      geometry::so3_right_jacobian_inverse(error.segment<3>(inertial::kRotation));
  Covariance JtP;
  JtP.noalias() = J.transpose() * P_prior_inverse;
  information.noalias() = JtP * J;
  information.block<6, 6>(kPose, kPose) += share * scan.H;
  ErrorState gradient = JtP * error;
  gradient.segment<6>(kPose) += share * scan.g;
  return -information.ldlt().solve(gradient);
}

}  // namespace

void note_fit(const NormalEquations& sum, const scan::DeskewedScan& scan, const UpdateConfig& config, UpdateResult& result) {
  const std::size_t features = scan.planar.size() + scan.edge.size();
  result.constraints = sum.count;
  result.information = sum.H;
  result.enough = sum.count >= config.min_constraints;
  result.matched_ratio = features == 0 ? 0.0 : static_cast<double>(sum.count) / static_cast<double>(features);
  result.inlier_ratio = sum.count == 0 ? 0.0 : static_cast<double>(sum.inliers) / static_cast<double>(sum.count);
  result.mean_residual_m = sum.count == 0 ? 0.0 : sum.absolute_sum_m / static_cast<double>(sum.count);
}

void widen_where_excluded(const NavState& prior, const Se3& T_odom_imu, Covariance& P_prior) {
  constexpr double kScan_s = 0.1;
  constexpr double kMostVelocity_mps = 0.5;
  auto P_pose = P_prior.block<6, 6>(kPose, kPose);
  const Vector6d error = geometry::boxminus(T_odom_imu, prior.T_odom_imu);
  if (error.dot(P_pose.ldlt().solve(error)) > 9.0) {
    P_pose.diagonal().head<3>().array() += error.head<3>().squaredNorm();
    P_pose.diagonal().tail<3>().array() += error.tail<3>().squaredNorm();
    P_prior.diagonal().segment<3>(inertial::kVelocity) +=
        (error.head<3>() / kScan_s).cwiseAbs().cwiseMin(kMostVelocity_mps).cwiseAbs2();
  }
}

UpdateResult iterated_update(const NavState& prior,
                             const Covariance& P_prior,
                             const scan::DeskewedScan& scan,
                             const map::VoxelMap& map,
                             const Se3& T_odom_imu_start,
                             const UpdateConfig& config,
                             registration::Association& association,
                             const std::optional<Eigen::Vector3d>& remembered_weak_odom) {
  UpdateResult result;
  const Covariance P_prior_inverse = P_prior.ldlt().solve(Covariance::Identity());
  NavState state = conditioned_on_pose(prior, P_prior, T_odom_imu_start);
  Covariance information = P_prior_inverse;
  NormalEquations sum;
  int associations = 0;
  bool associate = true;
  association.begin(scan);
  for (int i = 0; i < config.max_iterations; ++i) {
    if (associate) {
      registration::associate(scan, map, state.T_odom_imu, config.association, association);
      ++associations;
    }
    if (associate || result.localisability.weak.count == 0) {
      sum = registration::linearize(association.constraints.view(), state.T_odom_imu, config.kernel_m);
    }
    if (associate) {
      result.localisability = localisability_of(association.constraints.view(), sum.H, state.T_odom_imu, config.kernel_m,
                                                config.degenerate_share, remembered_weak_odom);
    }
    // A weak direction keeps the prior, but for what really faces it.
    if (result.localisability.weak.count != 0) {
      sum = registration::linearize_trusted(association.constraints.view(), state.T_odom_imu, config.kernel_m,
                                            result.localisability.weak);
    }
    if (sum.count < config.min_constraints) {
      break;
    }
    const ErrorState step =
        posterior_step(state, prior, P_prior_inverse, sum, config.information_share, information);
    state = inertial::boxplus(state, step);
    ++result.iterations;
    const bool small = step.segment<3>(inertial::kPosition).norm() < config.converged_m &&
                       step.segment<3>(inertial::kRotation).norm() < config.converged_rad;
    if (small && associations >= 2) {
      result.converged = true;
      break;
    }
    associate = associations < config.associations;
  }
  note_fit(sum, scan, config, result);
  if (!result.enough) {
    result.state = prior;
    result.P = P_prior;
    return result;
  }
  const Vector6d correction = geometry::boxminus(state.T_odom_imu, prior.T_odom_imu);
  result.innovation = correction.dot(P_prior.block<6, 6>(kPose, kPose).ldlt().solve(correction));
  state.T_odom_imu.rotation() = geometry::orthonormalized(state.T_odom_imu.rotation());
  result.state = state;
  result.P = information.ldlt().solve(Covariance::Identity());
  result.P = (0.5 * (result.P + result.P.transpose())).eval();
  return result;
}

}  // namespace slamd::odometry
