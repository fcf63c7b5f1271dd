#pragma once

#include <cstddef>

#include "core/base/bounded_vector.hpp"
#include "core/base/fixed_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/psf/random.hpp"

namespace slamd::psf {

/// How the particles move. Source: inertia and pulls after Kennedy and Eberhart (1995), values of design.md.
struct SwarmConfig {
  int steps = 10;  // "ten time steps" [Liu22]
  double inertia_first = 0.72;
  double inertia_last = 0.42;
  double pull = 1.2;               // c₁ = c₂, to the particle's own best and to the swarm's
  double max_velocity_boxes = 0.5;  // of the half box, per step
  double temper = 20.0;            // β: weights are exp(β ℓ)
  int first_resampling_step = 3;
  double roughening_boxes = 0.08;  // of the half box, shrinking to 0 at the last step
};

/// One hypothesis of the pose: ξ = (δp, δθ) relative to the prediction, with its memory.
struct Particle {
  geometry::Vector6d xi = geometry::Vector6d::Zero();
  geometry::Vector6d velocity = geometry::Vector6d::Zero();
  geometry::Vector6d best_xi = geometry::Vector6d::Zero();
  float log_likelihood = 0.0F;
  float best_log_likelihood = 0.0F;
};

/// The particles, in a box around the prediction.
/// Units: m, rad; log-likelihoods as ScanLikelihood's.
/// Real-time: allocates in the constructor only.
class Swarm {
 public:
  Swarm(const SwarmConfig& config, std::size_t max_particles);

  /// Spreads `count` particles over the box: the prediction itself, then one per stratum of each axis
  /// (Latin hypercube: every axis is covered evenly, whatever the count). [Liu22] "the little square".
  void spread(std::size_t count, const geometry::Vector6d& half_box, Random& random);

  /// Evaluates all particles and their memories, which forget what another σ or map level has said.
  /// evaluate(ξ) gives ℓ. Call it whenever σ or the level changed.
  template <typename Evaluate>
  void score(Evaluate&& evaluate) {
    for (Particle& particle : particles_) {
      particle.log_likelihood = evaluate(particle.xi);
      particle.best_log_likelihood = evaluate(particle.best_xi);
      if (particle.log_likelihood >= particle.best_log_likelihood) {
        particle.best_xi = particle.xi;
        particle.best_log_likelihood = particle.log_likelihood;
      }
    }
    find_best();
  }

  /// Moves every particle towards its own best and the swarm's: v ← w v + c₁u₁∘(pbest−ξ) + c₂u₂∘(gbest−ξ).
  void move(int step, Random& random);

  /// Resamples when few particles carry the weight: N_eff = 1/Σw² < N/2 → multinomial (Gordon et al., 1993), with
  /// roughening. Returns whether it did.
  bool resample(int step, Random& random);

  /// Returns the best places that lie apart from one another by more than `separation` half boxes, best first.
  static constexpr std::size_t kMaxModes = 4;
  FixedVector<std::size_t, kMaxModes> separated_modes(double separation) const;

  const Particle& operator[](std::size_t i) const { return particles_[i]; }
  std::size_t size() const { return particles_.size(); }
  const Particle& best() const { return particles_[best_]; }

 private:
  void find_best();

  SwarmConfig config_;
  geometry::Vector6d half_box_ = geometry::Vector6d::Ones();
  std::size_t best_ = 0;
  BoundedVector<Particle> particles_;
  // scratch, sized once
  BoundedVector<Particle> resampled_;
  BoundedVector<double> cumulative_weight_;
  BoundedVector<std::size_t> order_;
};

}  // namespace slamd::psf
