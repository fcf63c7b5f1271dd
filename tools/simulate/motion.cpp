#include "tools/simulate/motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::simulate {

namespace {

/// Coefficients of the quintic B-spline pieces: weight i at u in [0, 1) is Σ kPieces[i][k] uᵏ / 120.
constexpr double kPieces[6][6] = {{1, -5, 10, -10, 5, -1},      {26, -50, 20, 20, -20, 5}, {66, 0, -60, 0, 30, -10},
                                  {26, 50, 20, -20, -20, 10},   {1, 5, 10, 10, 5, -5},     {0, 0, 0, 0, 0, 1}};

/// The six weights at u in [0, 1), or their derivative of the given order (0..2).
std::array<double, 6> weights(double u, int order) {
  std::array<double, 6> w{};
  for (std::size_t i = 0; i < 6; ++i) {
    double sum = 0.0;
    for (int k = 5; k >= order; --k) {  // Horner
      const double factor = order == 0 ? 1.0 : (order == 1 ? k : k * (k - 1));
      sum = sum * u + factor * kPieces[i][k];
    }
    w[i] = sum / 120.0;
  }
  return w;
}

}  // namespace

Motion::Motion(std::vector<Channels> control_points, double knot_s)
    : points_(std::move(control_points)),
      knot_s_(knot_s),
      duration_s_(knot_s * (static_cast<double>(points_.size()) - 6.0)) {}

void Motion::vibrate(const Vibration& vibration, std::vector<double> strength) {
  vibration_ = vibration;
  strength_ = std::move(strength);
  strength_.resize(points_.size(), 0.0);
}

void Motion::append(const Channels& control_point, double strength) {
  points_.push_back(control_point);
  if (!strength_.empty()) {
    strength_.push_back(strength);
  }
  duration_s_ = knot_s_ * (static_cast<double>(points_.size()) - 6.0);
}

void Motion::evaluate(double t_s, int derivatives, Channels (&out)[3]) const {
  const double clamped = std::clamp(t_s, 0.0, duration_s_);
  const double place = clamped / knot_s_;
  const std::size_t first = std::min(static_cast<std::size_t>(place), points_.size() - 6);
  const double u = place - static_cast<double>(first);
  double scale = 1.0;
  double strength[3] = {};
  for (int order = 0; order <= derivatives; ++order, scale /= knot_s_) {
    const std::array<double, 6> w = weights(u, order);
    for (std::size_t channel = 0; channel < 6; ++channel) {
      double sum = 0.0;
      for (std::size_t i = 0; i < 6; ++i) {
        sum += w[i] * points_[first + i][channel];
      }
      out[order][channel] = scale * sum;
    }
    for (std::size_t i = 0; i < 6 && !strength_.empty(); ++i) {
      strength[order] += scale * w[i] * strength_[first + i];
    }
  }
  if (!strength_.empty()) {
    add_vibration(clamped, derivatives, strength, out);
  }
}

void Motion::add_vibration(double t_s, int derivatives, const double (&strength)[3], Channels (&out)[3]) const {
  for (const Vibration::Mode& mode : vibration_.modes) {
    const double w = mode.rate_radps;
    const double s = std::sin(w * t_s + mode.phase_rad);
    const double c = w * std::cos(w * t_s + mode.phase_rad);
    // The product of strength and sine, and its derivatives.
    const double shape[3] = {strength[0] * s, strength[1] * s + strength[0] * c,
                             strength[2] * s + 2.0 * strength[1] * c - strength[0] * w * w * s};
    for (int order = 0; order <= derivatives; ++order) {
      for (std::size_t channel = 0; channel < 6; ++channel) {
        out[order][channel] += mode.amplitude[channel] * shape[order];
      }
    }
  }
}

geometry::Se3 Motion::pose_at(double t_s) const {
  Channels c[3];
  evaluate(t_s, 0, c);
  return {geometry::rotation_from_rpy({c[0][5], c[0][4], c[0][3]}), Eigen::Vector3d(c[0][0], c[0][1], c[0][2])};
}

MotionState Motion::at(double t_s) const {
  Channels c[3];
  evaluate(t_s, 2, c);
  MotionState state;
  const double roll = c[0][5];
  const double pitch = c[0][4];
  state.T_world_base = {geometry::rotation_from_rpy({roll, pitch, c[0][3]}),
                        Eigen::Vector3d(c[0][0], c[0][1], c[0][2])};
  state.velocity_mps = {c[1][0], c[1][1], c[1][2]};
  state.acceleration_mps2 = {c[2][0], c[2][1], c[2][2]};
  const double yaw_rate = c[1][3];
  const double pitch_rate = c[1][4];
  const double roll_rate = c[1][5];
  // Euler rates to body rates for R = Rz(yaw) Ry(pitch) Rx(roll).
  state.rate_base_radps = {roll_rate - yaw_rate * std::sin(pitch),
                           pitch_rate * std::cos(roll) + yaw_rate * std::sin(roll) * std::cos(pitch),
                           -pitch_rate * std::sin(roll) + yaw_rate * std::cos(roll) * std::cos(pitch)};
  return state;
}

ShortMotion::ShortMotion(const Motion& motion, double t_s) : state_(motion.at(t_s)) {}

geometry::Se3 ShortMotion::pose_after(double dt_s) const {
  const Eigen::Vector3d phi = state_.rate_base_radps * dt_s;
  Eigen::Matrix3d turn;  // Exp(phi) to second order
  turn << 1.0 - 0.5 * (phi.y() * phi.y() + phi.z() * phi.z()), 0.5 * phi.x() * phi.y() - phi.z(),
      0.5 * phi.x() * phi.z() + phi.y(), 0.5 * phi.x() * phi.y() + phi.z(),
      1.0 - 0.5 * (phi.x() * phi.x() + phi.z() * phi.z()), 0.5 * phi.y() * phi.z() - phi.x(),
      0.5 * phi.x() * phi.z() - phi.y(), 0.5 * phi.y() * phi.z() + phi.x(),
      1.0 - 0.5 * (phi.x() * phi.x() + phi.y() * phi.y());
  return {state_.T_world_base.rotation() * turn, state_.T_world_base.translation() + dt_s * state_.velocity_mps +
                                                     0.5 * dt_s * dt_s * state_.acceleration_mps2};
}

}  // namespace slamd::simulate
