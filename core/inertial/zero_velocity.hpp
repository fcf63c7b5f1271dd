#pragma once

#include <span>

#include "core/inertial/propagation.hpp"
#include "core/sensor/wheel_sample.hpp"

namespace slamd::inertial {

/// When a vehicle passes for standing still, and how firmly that is believed.
struct ZeroVelocityConfig {
  std::size_t min_samples = 5;          // fewer say nothing about their spread
  double gyro_std_radps = 0.02;         // spread within the samples: more is a drive, or a hand
  double accel_std_mps2 = 0.35;
  double begin_below_mps = 0.03;        // the filter must know (2σ) the speed to be less before it is held,
  double sure_below_mps = 0.15;         // and this once it is, or where wheels stand
  double wheels_below_mps = 0.02;       // wheels that turn rule rest out
  double wheels_below_radps = 0.02;
  double speed_std_mps = 0.003;         // of the pseudo measurement "velocity is zero"
  double rate_std_radps = 5.0e-4;       // and of "the turn rate is zero", beside the gyroscope's noise
  double gate_sq = 20.5;                // χ²₆ at 0.998: what contradicts rest by more is a start
};

/// Holds a vehicle that stands while no scan does: velocity and turn rate are measured to be zero.
///
/// An inertial sensor alone cannot tell rest from an even drive: so the filter, too, must know by the last scans that the speed is
/// next to nothing (a creep of less than 3 cm/s without wheels is held all the same), and a start must show as an acceleration
/// that contradicts the zero velocity which was held till then.
/// Source: zero-velocity and zero-angular-rate updates with a gate on the normalised innovation (Skog et al., 2010).
/// Real-time: no allocation; O(samples + 17²).
class ZeroVelocityUpdate {
 public:
  explicit ZeroVelocityUpdate(const ZeroVelocityConfig& config) : config_(config) {}

  /// Updates a state that was propagated to the end of `samples` and `wheels` if these, and it, look like rest. Without
  /// samples the wheels decide alone, whatever the filter knew.
  /// Returns whether they do; otherwise nothing changes.
  bool update(std::span<const sensor::ImuSample> samples,
              std::span<const sensor::WheelSample> wheels,
              const ImuNoise& noise,
              NavState& state,
              Covariance& P);

  /// A scan says how fast the vehicle is: what was held before counts no longer.
  void release() { is_held_ = false; }

 private:
  double rate_variance_of(std::span<const sensor::ImuSample> samples, const ImuNoise& noise) const;
  bool is_still(std::span<const sensor::ImuSample> samples, std::span<const sensor::WheelSample> wheels) const;

  ZeroVelocityConfig config_;
  bool is_held_ = false;
};

}  // namespace slamd::inertial
