#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/inertial/nav_state.hpp"
#include "core/map/voxel_map.hpp"
#include "core/odometry/iterated_update.hpp"
#include "core/psf/random.hpp"
#include "core/scan/preprocessor.hpp"

namespace slamd::study {

/// What an estimator is asked: the prior, and a scan to be laid on the map.
struct Task {
  const inertial::NavState& prior;
  const inertial::Covariance& P_prior;
  const scan::DeskewedScan& scan;
  const map::VoxelMap& map;
  std::span<const Eigen::Vector3f>
      points_imu;  // of the likelihood: some of the scan's features, in the order of time
  bool indoor = false;
  std::uint64_t seed = 0;
};

/// One of the filters that are compared. All get the same prior, scan, map and likelihood points.
class Estimator {
 public:
  virtual ~Estimator() = default;

  /// Finds the posterior of a scan. What it says of the fit (matched, inliers) is judged by the
  /// odometry.
  virtual odometry::UpdateResult update(const Task& task) = 0;
};

/// Chooses `count` features evenly over the scan, planar and edge, in the order of time.
std::vector<Eigen::Vector3f> likelihood_points(const scan::DeskewedScan& scan, std::size_t count);

/// Makes a posterior out of a mean and covariance of the pose (in ξ about the prior); velocity,
/// biases and gravity follow by their correlation with it. Source: Rao–Blackwellised particle
/// filter (Doucet et al., 2000). `fit` says how the scan fits there, as the EKF's update does.
odometry::UpdateResult posterior_of(const Task& task,
                                    const geometry::Vector6d& mean,
                                    const geometry::Matrix6d& P_pose,
                                    const odometry::UpdateConfig& config,
                                    registration::Association& association);

/// Draws six values of variance 1.
geometry::Vector6d drawn_normal(psf::Random& random);

/// Mean and covariance of weighted places.
struct Moments {
  geometry::Vector6d mean = geometry::Vector6d::Zero();
  geometry::Matrix6d P = geometry::Matrix6d::Zero();
};

/// `weights` need no sum of 1. Adds a floor of 1 mm and 0.01°, below which some hundred particles
/// say nothing.
Moments moments_of(std::span<const geometry::Vector6d> places, std::span<const double> weights);

/// How many of the likelihood's points count: neighbours share their errors. ln p(z | x) is so many
/// times ℓ.
double independent_points(const Task& task, const odometry::UpdateConfig& config);

/// Returns exp(gain (ℓ − max ℓ)): weights from log-likelihoods.
std::vector<double> weights_of(std::span<const float> log_likelihoods, double gain);

}  // namespace slamd::study
