#include "tools/study/literal_psf.hpp"

#include <Eigen/Cholesky>

#include "core/registration/association.hpp"

namespace slamd::study {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

namespace {

constexpr double kEkfKernel_m = 0.2;
constexpr float kEkfGate_m = 1.0F;

/// Weights are likelihoods as they are; resampling is nothing but that.
psf::SwarmConfig literal_swarm(const odometry::OdometryConfig& odometry) {
  psf::SwarmConfig config = odometry.psf.swarm;
  config.first_resampling_step = 0;
  config.roughening_boxes = 0.0;
  config.temper = odometry.update.information_share * static_cast<double>(odometry.psf.points);
  return config;
}

}  // namespace

LiteralPsf::LiteralPsf(const odometry::OdometryConfig& config, TimeSteps time_steps)
    : config_(config.update),
      psf_(config.psf),
      time_steps_(time_steps),
      likelihood_(config.psf.points),
      swarm_(literal_swarm(config), kParticles),
      association_(config.preprocess) {}

odometry::UpdateResult LiteralPsf::update(const Task& task) {
  psf::Random random(task.seed, task.scan.index);
  little_square(task.indoor, random);
  ten_time_steps(task, random);
  suggested_density(task, random);
  return estimate(task);
}

/// [Liu22], "little square": 1 cm indoors, 10 cm outdoors. Deviates: in all six directions, with
/// design.md's angles; stratified.
void LiteralPsf::little_square(bool indoor, psf::Random& random) {
  Vector6d half;
  half.head<3>().setConstant(0.5 * (indoor ? psf_.little_indoor_m : psf_.little_outdoor_m));
  half.tail<3>().setConstant(0.5 * (indoor ? psf_.little_indoor_rad : psf_.little_outdoor_rad));
  swarm_.spread(kParticles, half, random);
}

/// [Liu22], "ten time steps", each with weights, multinomial resampling and a move of the swarm.
/// Deviates: resamples only when N_eff < N/2 (Liu and Chen, 1998).
void LiteralPsf::ten_time_steps(const Task& task, psf::Random& random) {
  const int steps = psf_.swarm.steps;
  for (int step = 0; step < steps; ++step) {
    likelihood_.set_points(received_by(step, task.points_imu));
    swarm_.score([&](const Vector6d& xi) { return log_likelihood(task, xi); });
    if (step + 1 < steps) {
      swarm_.resample(step, random);
      swarm_.move(step, random);
    }
  }
}

std::span<const Eigen::Vector3f> LiteralPsf::received_by(
    int step,
    std::span<const Eigen::Vector3f> points_imu) const {
  const auto slices =
      static_cast<std::size_t>(time_steps_ == TimeSteps::kSlices ? psf_.swarm.steps : 1);
  const std::size_t received = std::min(static_cast<std::size_t>(step) + 1, slices);
  return points_imu.first(points_imu.size() * received / slices);
}

/// [Liu22], "EKF-based particle filter": every particle draws from the density that an EKF suggests
/// for it. Source: extended particle filter (van der Merwe et al., 2000). Deviates: on the
/// likelihood's points.
void LiteralPsf::suggested_density(const Task& task, psf::Random& random) {
  const Matrix6d P_prior_inverse =
      Matrix6d(task.P_prior.topLeftCorner<6, 6>()).ldlt().solve(Matrix6d::Identity());
  suggested_.clear();
  for (std::size_t i = 0; i < swarm_.size(); ++i) {
    suggested_.push_back(ekf_draw(task, P_prior_inverse, swarm_[i].xi, random));
  }
}

Vector6d LiteralPsf::ekf_draw(const Task& task,
                              const Matrix6d& P_prior_inverse,
                              const Vector6d& xi,
                              psf::Random& random) {
  const Se3 T_odom_imu = geometry::boxplus(task.prior.T_odom_imu, xi);
  registration::associate_surfaces(
      task.points_imu, task.map, 0, kEkfGate_m, T_odom_imu, association_.constraints);
  const registration::NormalEquations sum =
      registration::linearize(association_.constraints.view(), T_odom_imu, kEkfKernel_m);
  const auto std_m = static_cast<double>(config_.association.planar_std_m);
  const double weight = config_.information_share / (std_m * std_m);
  const Eigen::LLT<Matrix6d> information(weight * sum.H + P_prior_inverse);
  const Vector6d mean = xi - information.solve(weight * sum.g + P_prior_inverse * xi);
  return mean + information.matrixU().solve(drawn_normal(random));  // A = LLᵀ: L⁻ᵀu has covariance A⁻¹
}

/// The weighted mean of the particles. Deviates: weights by the likelihood alone, since the density
/// of particles that a swarm has moved is not known.
odometry::UpdateResult LiteralPsf::estimate(const Task& task) {
  std::vector<float> log_likelihoods;
  for (const Vector6d& xi : suggested_) {
    log_likelihoods.push_back(log_likelihood(task, xi));
  }
  const Moments moments =
      moments_of(suggested_, weights_of(log_likelihoods, independent_points(task, config_)));
  return posterior_of(task, moments.mean, moments.P, config_, association_);
}

float LiteralPsf::log_likelihood(const Task& task, const Vector6d& xi) const {
  return likelihood_.with_look_ups(task.map,
                                   0,
                                   geometry::boxplus(task.prior.T_odom_imu, xi),
                                   static_cast<float>(psf_.sigma_last_m));
}

}  // namespace slamd::study
