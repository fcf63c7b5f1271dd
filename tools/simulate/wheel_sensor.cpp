#include "tools/simulate/wheel_sensor.hpp"

#include <cmath>

namespace slamd::simulate {

WheelSensor::WheelSensor(const Motion& motion, double rate_hz, const WheelErrors& errors, std::uint64_t seed)
    : motion_(motion), rate_hz_(rate_hz), errors_(errors), noise_(seed, 80) {}

bool WheelSensor::next(double& t_s, WheelReading& reading) {
  t_s = static_cast<double>(index_) / rate_hz_;
  if (t_s > motion_.duration_s()) {
    return false;
  }
  const MotionState state = motion_.at(t_s);
  const double v = (state.T_world_base.rotation().transpose() * state.velocity_mps).x();
  const double w = state.rate_base_radps.z() * (1.0 + errors_.slip_in_turns);
  // A spin lasts half a second and is decided for each of them.
  const auto half_second = static_cast<std::uint64_t>(2.0 * t_s);
  const bool spins = std::abs(v) > 0.2 && noise_.uniform(half_second) < 0.5 * errors_.slip_chance;
  const double spin = spins ? 1.0 + noise_.uniform(1'000'000 + half_second, 0.2, 0.8) : 1.0;
  const auto side = [&](double sign, std::uint64_t stream) {
    const double true_mps = spin * (v + sign * 0.5 * errors_.track_m * w);
    return true_mps * (1.0 + errors_.scale * noise_.normal(stream) +
                       errors_.noise * noise_.normal(2'000'000 + 4 * index_ + stream));
  };
  reading.left_mps = side(-1.0, 1);
  reading.right_mps = side(1.0, 2);
  left_m_ += reading.left_mps / rate_hz_;
  right_m_ += reading.right_mps / rate_hz_;
  reading.left_ticks = std::llround(left_m_ * errors_.ticks_per_m);
  reading.right_ticks = std::llround(right_m_ * errors_.ticks_per_m);
  reading.v_mps = 0.5 * (reading.left_mps + reading.right_mps);
  reading.w_radps = (reading.right_mps - reading.left_mps) / errors_.track_m;
  ++index_;
  return true;
}

}  // namespace slamd::simulate
