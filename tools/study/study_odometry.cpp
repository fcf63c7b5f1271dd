#include "tools/study/study_odometry.hpp"

namespace slamd::study {

using odometry::Cause;
using odometry::UpdateResult;

StudyOdometry::StudyOdometry(const odometry::OdometryConfig& config)
    : Odometry(config), points_(config.psf.points) {}

void StudyOdometry::use(Estimator* estimator, std::uint64_t seed) {
  estimator_ = estimator;
  seed_ = seed;
}

void StudyOdometry::disturb(const geometry::Vector6d& error, const inertial::Covariance& told) {
  inertial::NavState wrong = state();
  wrong.T_odom_imu = geometry::boxplus(wrong.T_odom_imu, error);
  go_on_from(wrong, covariance() + told);
}

UpdateResult StudyOdometry::registered(const scan::DeskewedScan& scan,
                                       const inertial::NavState& prior,
                                       const inertial::Covariance& P_prior) {
  const inertial::NavState state_before = state();
  const inertial::Covariance P_before = covariance();
  const psf::ParticleSwarmFilter filter_before = filter();
  go_on_from(prior, P_prior);
  psf::Answer swarm;
  const UpdateResult result = update(scan, Cause::kNone, swarm);
  go_on_from(state_before, P_before);
  filter() = filter_before;
  return result;
}

UpdateResult StudyOdometry::update(const scan::DeskewedScan& scan,
                                   Cause prediction_cause,
                                   psf::Answer& swarm) {
  if (estimator_ == nullptr) {
    return Odometry::update(scan, prediction_cause, swarm);
  }
  const std::vector<Eigen::Vector3f> points_imu = likelihood_points(scan, points_);
  return estimator_->update({state(), covariance(), scan, map(), points_imu, indoor(), seed_});
}

}  // namespace slamd::study
