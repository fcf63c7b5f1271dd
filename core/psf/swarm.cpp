#include "core/psf/swarm.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slamd::psf {

using geometry::Vector6d;

Swarm::Swarm(const SwarmConfig& config, std::size_t max_particles)
    : config_(config),
      particles_(max_particles),
      resampled_(max_particles),
      cumulative_weight_(max_particles),
      order_(max_particles) {}

void Swarm::spread(std::size_t count, const Vector6d& half_box, Random& random) {
  half_box_ = half_box;
  particles_.clear();
  particles_.resize(std::min(count, particles_.capacity()));
  const std::size_t strata = particles_.size() - 1;
  order_.resize(strata);
  for (int axis = 0; axis < 6; ++axis) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    for (std::size_t i = strata; i > 1; --i) {
      std::swap(order_[i - 1], order_[random.next() % i]);
    }
    for (std::size_t i = 0; i < strata; ++i) {
      const double place = (static_cast<double>(order_[i]) + random.uniform()) / static_cast<double>(strata);
      particles_[i + 1].xi[axis] = half_box[axis] * (2.0 * place - 1.0);
    }
  }
  for (Particle& particle : particles_) {
    particle.best_xi = particle.xi;
  }
}

void Swarm::move(int step, Random& random) {
  const double ratio = config_.steps < 2 ? 1.0 : static_cast<double>(step) / (config_.steps - 1);
  const double inertia = config_.inertia_first + ratio * (config_.inertia_last - config_.inertia_first);
  const Vector6d best_xi = particles_[best_].best_xi;
  for (Particle& particle : particles_) {
    for (int axis = 0; axis < 6; ++axis) {
      const double limit = config_.max_velocity_boxes * half_box_[axis];
      const double velocity = inertia * particle.velocity[axis] +
                              config_.pull * random.uniform() * (particle.best_xi[axis] - particle.xi[axis]) +
                              config_.pull * random.uniform() * (best_xi[axis] - particle.xi[axis]);
      particle.velocity[axis] = std::clamp(velocity, -limit, limit);
      particle.xi[axis] += particle.velocity[axis];
    }
  }
}

bool Swarm::resample(int step, Random& random) {
  if (step < config_.first_resampling_step) {
    return false;
  }
  float best = -1e30F;
  for (const Particle& particle : particles_) {
    best = std::max(best, particle.log_likelihood);
  }
  double sum = 0.0;
  double square_sum = 0.0;
  cumulative_weight_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const double weight = std::exp(config_.temper * static_cast<double>(particles_[i].log_likelihood - best));
    sum += weight;
    square_sum += weight * weight;
    cumulative_weight_[i] = sum;
  }
  const double effective = sum * sum / square_sum;
  if (2.0 * effective >= static_cast<double>(particles_.size())) {
    return false;
  }
  const double roughening =
      config_.roughening_boxes * (1.0 - static_cast<double>(step + 1) / static_cast<double>(config_.steps));
  resampled_.resize(particles_.size());
  for (Particle& copy : resampled_) {
    const double ticket = random.uniform() * sum;
    const auto* place = std::lower_bound(cumulative_weight_.begin(), cumulative_weight_.end(), ticket);
    const auto parent = std::min<std::size_t>(static_cast<std::size_t>(place - cumulative_weight_.begin()),
                                              particles_.size() - 1);
    copy = particles_[parent];
    for (int axis = 0; axis < 6; ++axis) {
      copy.xi[axis] += roughening * half_box_[axis] * random.normal();
    }
  }
  // The swarm's best memory must survive the lottery.
  resampled_[0].best_xi = particles_[best_].best_xi;
  resampled_[0].best_log_likelihood = particles_[best_].best_log_likelihood;
  std::swap(particles_, resampled_);
  find_best();
  return true;
}

void Swarm::find_best() {
  best_ = 0;
  for (std::size_t i = 1; i < particles_.size(); ++i) {
    if (particles_[i].best_log_likelihood > particles_[best_].best_log_likelihood) {
      best_ = i;
    }
  }
}

FixedVector<std::size_t, Swarm::kMaxModes> Swarm::separated_modes(double separation) const {
  FixedVector<std::size_t, kMaxModes> modes;
  while (!modes.full()) {
    std::size_t next = particles_.size();
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const bool apart = std::all_of(modes.begin(), modes.end(), [&](std::size_t mode) {
        const Vector6d d = (particles_[i].best_xi - particles_[mode].best_xi).cwiseQuotient(half_box_);
        return d.cwiseAbs().maxCoeff() > separation;
      });
      if (apart && (next == particles_.size() ||
                    particles_[i].best_log_likelihood > particles_[next].best_log_likelihood)) {
        next = i;
      }
    }
    if (next == particles_.size()) {
      break;
    }
    modes.push_back(next);
  }
  return modes;
}

}  // namespace slamd::psf
