#include "tools/study/ekf.hpp"

#include "core/registration/gauss_newton.hpp"

namespace slamd::study {

using geometry::Se3;
using odometry::UpdateResult;

Ekf::Ekf(const odometry::OdometryConfig& config)
    : config_(config.update), association_(config.preprocess) {}

UpdateResult Ekf::update(const Task& task) {
  return odometry::iterated_update(
      task.prior, task.P_prior, task.scan, task.map, task.prior.T_odom_imu, config_, association_);
}

CoarseToFineEkf::CoarseToFineEkf(const odometry::OdometryConfig& config)
    : config_(config.update), psf_(config.psf), association_(config.preprocess) {}

UpdateResult CoarseToFineEkf::update(const Task& task) {
  const Se3 T_odom_imu = registration::align_to_surfaces(
      task.points_imu, task.map, task.prior.T_odom_imu, registration::kCoarseToFine, association_.constraints);
  if (psf::is_same_mode(T_odom_imu, task.prior.T_odom_imu, psf_)) {
    return odometry::iterated_update(task.prior,
                                     task.P_prior,
                                     task.scan,
                                     task.map,
                                     task.prior.T_odom_imu,
                                     config_,
                                     association_);
  }
  inertial::Covariance P_prior = task.P_prior;
  odometry::widen_where_excluded(task.prior, T_odom_imu, P_prior);
  UpdateResult result = odometry::iterated_update(
      task.prior, P_prior, task.scan, task.map, T_odom_imu, config_, association_);
  result.innovation = 0.0;  // there is no prior left that it could contradict
  return result;
}

}  // namespace slamd::study
