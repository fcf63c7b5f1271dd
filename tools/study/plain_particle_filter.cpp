#include "tools/study/plain_particle_filter.hpp"

#include <Eigen/Cholesky>

#include "tools/study/systematic_resampling.hpp"

namespace slamd::study {

using geometry::Matrix6d;
using geometry::Vector6d;

PlainParticleFilter::PlainParticleFilter(const odometry::OdometryConfig& config)
    : config_(config.update),
      psf_(config.psf),
      likelihood_(config.psf.points),
      association_(config.preprocess) {}

odometry::UpdateResult PlainParticleFilter::update(const Task& task) {
  psf::Random random(task.seed, task.scan.index);
  likelihood_.set_points(task.points_imu);
  sample_prior(task, random);
  resample(importance_weights(task), random);
  const std::vector<double> equal(particles_.size(), 1.0);
  const Moments moments = moments_of(particles_, equal);
  return posterior_of(task, moments.mean, moments.P, config_, association_);
}

void PlainParticleFilter::sample_prior(const Task& task, psf::Random& random) {
  const Matrix6d root = Matrix6d(task.P_prior.topLeftCorner<6, 6>()).llt().matrixL();
  particles_.resize(kParticles);
  for (Vector6d& particle : particles_) {
    particle = root * drawn_normal(random);
  }
}

std::vector<double> PlainParticleFilter::importance_weights(const Task& task) {
  std::vector<float> log_likelihoods;
  for (const Vector6d& particle : particles_) {
    log_likelihoods.push_back(
        likelihood_.with_look_ups(task.map,
                                  0,
                                  geometry::boxplus(task.prior.T_odom_imu, particle),
                                  static_cast<float>(psf_.sigma_last_m)));
  }
  return weights_of(log_likelihoods, independent_points(task, config_));
}

void PlainParticleFilter::resample(std::span<const double> weights, psf::Random& random) {
  std::vector<Vector6d> children;
  for (const std::size_t parent : systematic_resampling(weights, random.uniform())) {
    children.push_back(particles_[parent]);
  }
  particles_ = std::move(children);
}

}  // namespace slamd::study
