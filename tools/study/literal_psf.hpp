#pragma once

#include "core/odometry/odometry_config.hpp"
#include "core/psf/likelihood.hpp"
#include "core/psf/swarm.hpp"
#include "tools/study/estimator.hpp"

namespace slamd::study {

/// What the "ten time steps" of [Liu22] are.
enum class TimeSteps {
  kWholeScan,  // ten moves on the whole scan
  kSlices,     // the scan comes in ten slices: step t knows the first t of them
};

/// The particle swarm filter as [Liu22] describes it, literally: particles in a little square of
/// fixed side around the prediction, ten time steps of the swarm with multinomial resampling, the
/// EKF as suggested density, and only then the map's update. No widening of the square, no
/// annealing, no recovery, no gate: those are the product's. Source: [Liu22]. It leaves the number
/// of particles, the weights' and the swarm's coefficients open: design.md's.
class LiteralPsf : public Estimator {
 public:
  static constexpr std::size_t kParticles = 32;  // as the product's little swarm

  LiteralPsf(const odometry::OdometryConfig& config, TimeSteps time_steps);

  odometry::UpdateResult update(const Task& task) override;

 private:
  void little_square(bool indoor, psf::Random& random);
  void ten_time_steps(const Task& task, psf::Random& random);
  std::span<const Eigen::Vector3f> received_by(int step,
                                               std::span<const Eigen::Vector3f> points_imu) const;
  void suggested_density(const Task& task, psf::Random& random);
  geometry::Vector6d ekf_draw(const Task& task,
                              const geometry::Matrix6d& P_prior_inverse,
                              const geometry::Vector6d& xi,
                              psf::Random& random);
  odometry::UpdateResult estimate(const Task& task);
  float log_likelihood(const Task& task, const geometry::Vector6d& xi) const;

  odometry::UpdateConfig config_;
  psf::PsfConfig psf_;
  TimeSteps time_steps_;
  psf::ScanLikelihood likelihood_;
  psf::Swarm swarm_;
  std::vector<geometry::Vector6d> suggested_;
  registration::Association association_;
};

}  // namespace slamd::study
