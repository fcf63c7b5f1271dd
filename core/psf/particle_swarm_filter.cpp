#include "core/psf/particle_swarm_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace slamd::psf {

using geometry::boxminus;
using geometry::boxplus;
using geometry::Se3;
using geometry::Vector6d;

namespace {

constexpr std::size_t kFineLevel = 0;
constexpr std::size_t kCoarseLevel = 1;
constexpr int kCoarseSteps = 4;  // true look-ups on the larger cells; after them stored surfaces

bool stores_surfaces_before(int step) { return step == 4 || step == 7; }  // steps 5 and 8, counted from 1

/// Standard deviation of the particles' best positions: how many places the scan could be at. Units: m.
double spread_m(const Swarm& swarm) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double square_sum = 0.0;
  for (std::size_t i = 0; i < swarm.size(); ++i) {
    sum += swarm[i].best_xi.head<3>();
    square_sum += swarm[i].best_xi.head<3>().squaredNorm();
  }
  const double n = static_cast<double>(swarm.size());
  return std::sqrt(std::max(0.0, square_sum / n - (sum / n).squaredNorm()));
}

}  // namespace

bool is_same_mode(const Se3& a, const Se3& b, const PsfConfig& config) {
  const Vector6d apart = boxminus(a, b);
  return apart.head<3>().norm() < config.same_mode_m && apart.tail<3>().norm() < config.same_mode_rad;
}

ParticleSwarmFilter::ParticleSwarmFilter(const PsfConfig& config, std::uint64_t seed)
    : config_(config),
      seed_(seed),
      likelihood_(config.points),
      swarm_(config.swarm, config.max_particles),
      constraints_(2 * config.points) {}

void ParticleSwarmFilter::reset() {
  has_running_ = false;
  growth_ = 1.0;
}

Answer ParticleSwarmFilter::answer(std::span<const Eigen::Vector3f> points_imu,
                                   const map::VoxelMap& map,
                                   const Question& question) {
  Random random(seed_, question.scan_index);
  likelihood_.set_points(points_imu);
  const auto gate_sigma = static_cast<float>(config_.gate_sigma_m);
  const auto fit = [&](const Se3& T_odom_imu) {
    return likelihood_.with_look_ups(map, kFineLevel, T_odom_imu, gate_sigma);
  };

  Answer best;
  best.T_odom_imu = question.T_odom_imu_plain;
  best.plain_log_likelihood = best.log_likelihood = fit(question.T_odom_imu_plain);
  best.recovery = is_recovery(question, best.plain_log_likelihood);

  run_swarm(map, question, best.recovery, random);

  // EKF-based particle filter [Liu22]: Gauss–Newton from the best separated modes; in recovery also the
  // coarse-to-fine alignment, which needs no luck. The gate: plain, unless a mode is clearly better.
  const auto score_of = [&](const Se3& T_odom_imu, float log_likelihood) {
    return config_.gate_gain * static_cast<double>(log_likelihood) + log_prior(question, T_odom_imu);
  };
  double best_score = score_of(best.T_odom_imu, best.log_likelihood) + config_.gate_margin;
  const auto challenge = [&](const Se3& T_odom_imu) {
    // So near it is the plain update's own mode, which the final update would come back to.
    if (is_same_mode(T_odom_imu, question.T_odom_imu_plain, config_)) {
      return;
    }
    if (best.recovery && !question.distrust_prior && !fits_better_where_both_are_known(map, question, T_odom_imu)) {
      return;
    }
    const float log_likelihood = fit(T_odom_imu);
    const double score = score_of(T_odom_imu, log_likelihood);
    if (score > best_score) {
      best_score = score;
      best.T_odom_imu = T_odom_imu;
      best.log_likelihood = log_likelihood;
      best.swarm_won = true;
    }
  };
  const auto modes = swarm_.separated_modes(config_.mode_separation_boxes);
  for (const std::size_t mode : modes) {
    const Se3 T_odom_imu_mode = boxplus(question.T_odom_imu_prior, swarm_[mode].best_xi);
    // A mode of the little swarm that fits no better than the plain update cannot win: spare the alignment.
    if (!best.recovery && config_.gate_gain * static_cast<double>(fit(T_odom_imu_mode) - best.log_likelihood) < 0.0) {
      continue;
    }
    challenge(registration::align_to_surfaces(likelihood_.points_imu(), map, T_odom_imu_mode, {}, constraints_));
  }
  if (best.recovery) {
    challenge(registration::align_to_surfaces(
        likelihood_.points_imu(), map, question.T_odom_imu_prior, registration::kCoarseToFine, constraints_));
  }
  best.particles = static_cast<std::uint32_t>(swarm_.size());
  best.modes = static_cast<std::uint32_t>(modes.size());
  best.spread_m = spread_m(swarm_);
  remember(best);
  return best;
}

bool ParticleSwarmFilter::is_recovery(const Question& question, float plain_log_likelihood) const {
  return question.distrust_prior ||
         (has_running_ &&
          static_cast<double>(plain_log_likelihood) < running_log_likelihood_ - config_.trigger_drop);
}

Vector6d ParticleSwarmFilter::half_box(const Question& question, bool recovery) const {
  Vector6d half;
  if (recovery) {
    half.head<3>().setConstant(std::min(growth_ * config_.recovery_m, config_.max_recovery_m));
    half.tail<3>().setConstant(std::min(growth_ * config_.recovery_rad, config_.max_recovery_rad));
    // Gravity holds roll, pitch and height better than the rest (methods.md 1.4).
    half[2] *= 0.3;
    half[3] *= 0.3;
    half[4] *= 0.3;
  } else {
    half.head<3>().setConstant(0.5 * (question.indoor ? config_.little_indoor_m : config_.little_outdoor_m));
    half.tail<3>().setConstant(0.5 * (question.indoor ? config_.little_indoor_rad : config_.little_outdoor_rad));
  }
  return half.cwiseMax(2.0 * question.P_prior.diagonal().cwiseSqrt())
      .cwiseMin((Vector6d() << Eigen::Vector3d::Constant(config_.max_recovery_m),
                 Eigen::Vector3d::Constant(config_.max_recovery_rad))
                    .finished());
}

void ParticleSwarmFilter::run_swarm(const map::VoxelMap& map, const Question& question, bool recovery, Random& random) {
  const std::size_t count =
      recovery ? std::min(config_.max_particles,
                          static_cast<std::size_t>(growth_ * static_cast<double>(config_.recovery_particles)))
               : config_.little_particles;
  swarm_.spread(count, half_box(question, recovery), random);
  const int steps = config_.swarm.steps;
  const double cooling = std::pow(config_.sigma_last_m / config_.sigma_first_m, 1.0 / std::max(1, steps - 1));
  double sigma_m = config_.sigma_first_m;
  bool stored = false;
  for (int step = 0; step < steps; ++step, sigma_m *= cooling) {
    const auto sigma = static_cast<float>(sigma_m);
    if (!recovery && !stored) {
      likelihood_.cache_surfaces(map, kFineLevel, question.T_odom_imu_plain);
      stored = true;
    } else if (recovery && stores_surfaces_before(step)) {
      likelihood_.cache_surfaces(map, kFineLevel, boxplus(question.T_odom_imu_prior, swarm_.best().best_xi));
      stored = true;
    }
    const std::size_t level = step < kCoarseSteps ? kCoarseLevel : kFineLevel;
    swarm_.score([&](const Vector6d& xi) {
      const Se3 T_odom_imu = boxplus(question.T_odom_imu_prior, xi);
      return stored ? likelihood_.with_cache(T_odom_imu, sigma)
                    : likelihood_.with_look_ups(map, level, T_odom_imu, sigma);
    });
    if (step + 1 < steps) {
      swarm_.resample(step, random);
      swarm_.move(step, random);
    }
  }
}

// A likelihood that has fallen is no evidence against the prediction by itself: a scan that sees new ground falls just
// so, and fits better wherever it can be laid on old ground. So the two are compared where both can be judged.
bool ParticleSwarmFilter::fits_better_where_both_are_known(const map::VoxelMap& map,
                                                           const Question& question,
                                                           const Se3& T_odom_imu) const {
  const auto sigma = static_cast<float>(config_.gate_sigma_m);
  const ScanLikelihood::Comparison both =
      likelihood_.compare(map, kFineLevel, T_odom_imu, question.T_odom_imu_plain, sigma);
  const double score = config_.gate_gain * static_cast<double>(both.a - both.b) + log_prior(question, T_odom_imu) -
                       log_prior(question, question.T_odom_imu_plain);
  return static_cast<double>(both.share) >= config_.min_shared_points && score > config_.gate_margin;
}

double ParticleSwarmFilter::log_prior(const Question& question, const Se3& T_odom_imu) const {
  const Vector6d xi = boxminus(T_odom_imu, question.T_odom_imu_prior);
  const double narrow = -0.5 * xi.dot(question.P_prior.ldlt().solve(xi));
  // While the plain update contradicts neither the prediction nor the map, the prediction was right: new surroundings, such
  // as a room behind a door, can fit well where they do not belong.
  if (!question.distrust_prior) {
    return narrow;
  }
  const Vector6d wide_std = 0.5 * half_box(question, true);
  const double wide = -0.5 * xi.cwiseQuotient(wide_std).squaredNorm() - config_.wide_penalty;
  return std::max(narrow, wide);
}

void ParticleSwarmFilter::remember(const Answer& answer) {
  const double log_likelihood = static_cast<double>(answer.log_likelihood);
  if (!has_running_) {
    running_log_likelihood_ = log_likelihood;
    has_running_ = true;
  }
  const bool healthy = log_likelihood > running_log_likelihood_ - config_.trigger_drop;
  growth_ = healthy ? 1.0 : 2.0;
  // An unhealthy scan moves the mean slowly: a new kind of place becomes normal after a while, a lost one does not hide.
  running_log_likelihood_ += (healthy ? 0.1 : 0.02) * (log_likelihood - running_log_likelihood_);
}

}  // namespace slamd::psf
