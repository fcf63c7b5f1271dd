#pragma once

#include "core/odometry/odometry_config.hpp"
#include "core/psf/likelihood.hpp"
#include "core/psf/random.hpp"
#include "tools/study/estimator.hpp"

namespace slamd::study {

/// A particle filter without a swarm: sampling importance resampling of the pose, with as many
/// evaluations of the likelihood as the literal PSF and the product's little swarm have. Source:
/// x_i ~ p(x | x⁻), w_i ∝ p(z | x_i), resampling (Gordon, Salmond and Smith, 1993); between scans
/// the particles are kept as their mean and covariance (Kotecha and Djurić, 2003).
class PlainParticleFilter : public Estimator {
 public:
  static constexpr std::size_t kParticles = 320;

  explicit PlainParticleFilter(const odometry::OdometryConfig& config);

  odometry::UpdateResult update(const Task& task) override;

 private:
  void sample_prior(const Task& task, psf::Random& random);
  std::vector<double> importance_weights(const Task& task);
  void resample(std::span<const double> weights, psf::Random& random);

  odometry::UpdateConfig config_;
  psf::PsfConfig psf_;
  psf::ScanLikelihood likelihood_;
  std::vector<geometry::Vector6d> particles_;
  registration::Association association_;
};

}  // namespace slamd::study
