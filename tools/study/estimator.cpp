#include "tools/study/estimator.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/registration/association.hpp"

namespace slamd::study {

using geometry::Matrix6d;
using geometry::Vector6d;
using inertial::kErrorStates;
using odometry::UpdateResult;

namespace {

constexpr double kPositionFloor_m = 1e-3;
constexpr double kRotationFloor_rad = 0.01 * M_PI / 180.0;

}  // namespace

std::vector<Eigen::Vector3f> likelihood_points(const scan::DeskewedScan& scan, std::size_t count) {
  std::vector<Eigen::Vector3f> all;
  const std::size_t planar = scan.planar.size();
  const std::size_t edge = scan.edge.size();
  for (std::size_t i = 0, j = 0; i < planar || j < edge;) {
    // Both lists are in the order of time and spread evenly over it.
    const bool edge_first = i == planar || (j < edge && (2 * j + 1) * planar < (2 * i + 1) * edge);
    all.push_back(edge_first ? scan.edge[j++].p_imu : scan.planar[i++].p_imu);
  }
  const std::size_t wanted = std::min(all.size(), count);
  std::vector<Eigen::Vector3f> chosen;
  for (std::size_t k = 0; k < wanted; ++k) {
    chosen.push_back(all[k * all.size() / wanted]);
  }
  return chosen;
}

UpdateResult posterior_of(const Task& task,
                          const Vector6d& mean,
                          const Matrix6d& P_pose,
                          const odometry::UpdateConfig& config,
                          registration::Association& association) {
  UpdateResult result;
  const Matrix6d P_prior_pose = task.P_prior.topLeftCorner<6, 6>();
  const Eigen::Matrix<double, kErrorStates, 6> K =
      P_prior_pose.ldlt().solve(task.P_prior.topRows<6>()).transpose();
  result.state = inertial::boxplus(task.prior, K * mean);
  result.state.T_odom_imu = geometry::boxplus(task.prior.T_odom_imu, mean);
  result.P = task.P_prior + K * (P_pose - P_prior_pose) * K.transpose();
  result.P = (0.5 * (result.P + result.P.transpose())).eval();

  association.begin(task.scan);
  registration::associate(task.scan, task.map, result.state.T_odom_imu, config.association, association);
  const registration::NormalEquations sum =
      registration::linearize(association.constraints.view(), result.state.T_odom_imu, config.kernel_m);
  odometry::note_fit(sum, task.scan, config, result);
  return result;
}

Vector6d drawn_normal(psf::Random& random) {
  Vector6d unit;
  for (double& value : unit) {
    value = random.normal();
  }
  return unit;
}

Moments moments_of(std::span<const Vector6d> places, std::span<const double> weights) {
  Moments moments;
  double sum = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    moments.mean += weights[i] * places[i];
    sum += weights[i];
  }
  moments.mean /= sum;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vector6d d = places[i] - moments.mean;
    moments.P += weights[i] / sum * d * d.transpose();
  }
  moments.P.diagonal().head<3>().array() += kPositionFloor_m * kPositionFloor_m;
  moments.P.diagonal().tail<3>().array() += kRotationFloor_rad * kRotationFloor_rad;
  return moments;
}

double independent_points(const Task& task, const odometry::UpdateConfig& config) {
  return config.information_share * static_cast<double>(task.points_imu.size());
}

std::vector<double> weights_of(std::span<const float> log_likelihoods, double gain) {
  const float best = *std::max_element(log_likelihoods.begin(), log_likelihoods.end());
  std::vector<double> weights;
  for (const float log_likelihood : log_likelihoods) {
    weights.push_back(std::exp(gain * static_cast<double>(log_likelihood - best)));
  }
  return weights;
}

}  // namespace slamd::study
