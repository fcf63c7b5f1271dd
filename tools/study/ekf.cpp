#include "tools/study/ekf.hpp"

#include <Eigen/Cholesky>

#include "core/registration/gauss_newton.hpp"

namespace slamd::study {

using geometry::Se3;
using geometry::Vector6d;
using odometry::UpdateResult;

namespace {

std::size_t constraints_of(const odometry::OdometryConfig& config) {
  return config.preprocess.max_planar + 2 * config.preprocess.max_edge;
}

}  // namespace

Ekf::Ekf(const odometry::OdometryConfig& config)
    : config_(config.update), constraints_(constraints_of(config)) {}

UpdateResult Ekf::update(const Task& task) {
  return odometry::iterated_update(
      task.prior, task.P_prior, task.scan, task.map, task.prior.T_odom_imu, config_, constraints_);
}

CoarseToFineEkf::CoarseToFineEkf(const odometry::OdometryConfig& config)
    : config_(config.update), psf_(config.psf), constraints_(constraints_of(config)) {}

UpdateResult CoarseToFineEkf::update(const Task& task) {
  const Se3 T_odom_imu = coarse_to_fine(task);
  const Vector6d apart = geometry::boxminus(T_odom_imu, task.prior.T_odom_imu);
  if (apart.head<3>().norm() < psf_.same_mode_m && apart.tail<3>().norm() < psf_.same_mode_rad) {
    return odometry::iterated_update(task.prior,
                                     task.P_prior,
                                     task.scan,
                                     task.map,
                                     task.prior.T_odom_imu,
                                     config_,
                                     constraints_);
  }
  UpdateResult result = odometry::iterated_update(task.prior,
                                                  widened(task, T_odom_imu),
                                                  task.scan,
                                                  task.map,
                                                  T_odom_imu,
                                                  config_,
                                                  constraints_);
  result.innovation = 0.0;  // there is no prior left that it could contradict
  return result;
}

Se3 CoarseToFineEkf::coarse_to_fine(const Task& task) {
  const registration::GaussNewtonConfig config{
      .iterations = 30, .gate_first_m = 2.0F, .gate_last_m = 0.3F, .coarse_iterations = 15};
  return registration::align_to_surfaces(
      task.points_imu, task.map, task.prior.T_odom_imu, config, constraints_);
}

inertial::Covariance CoarseToFineEkf::widened(const Task& task, const Se3& T_odom_imu) const {
  inertial::Covariance P = task.P_prior;
  const Vector6d error = geometry::boxminus(T_odom_imu, task.prior.T_odom_imu);
  if (error.dot(P.topLeftCorner<6, 6>().ldlt().solve(error)) > 9.0) {
    constexpr double kScan_s = 0.1;
    P.topLeftCorner<6, 6>() += error * error.transpose();
    P.diagonal().segment<3>(inertial::kVelocity) += (error.head<3>() / kScan_s).cwiseAbs2();
  }
  return P;
}

}  // namespace slamd::study
