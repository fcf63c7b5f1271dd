#include "tools/simulate/motion.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/so3.hpp"

namespace slamd::simulate {

namespace {

/// The six quintic B-spline weights at u in [0, 1), or their derivative of the given order (0..2).
/// Built from the truncated powers Σ (−1)^j C(6, j) (x − j)₊⁵ / 120.
std::array<double, 6> weights(double u, int order) {
  constexpr double kBinomial[7] = {1, 6, 15, 20, 15, 6, 1};
  constexpr double kFactor[3] = {1.0 / 120.0, 5.0 / 120.0, 20.0 / 120.0};
  std::array<double, 6> w{};
  for (int i = 0; i < 6; ++i) {
    const double x = u + 5 - i;  // of control point i
    for (int j = 0; j <= 6 && x > j; ++j) {
      double power = 1.0;
      for (int k = 0; k < 5 - order; ++k) {
        power *= x - j;
      }
      w[static_cast<std::size_t>(i)] += (j % 2 == 0 ? 1.0 : -1.0) * kBinomial[j] * power;
    }
    w[static_cast<std::size_t>(i)] *= kFactor[order];
  }
  return w;
}

}  // namespace

Motion::Motion(std::vector<Channels> control_points, double knot_s)
    : points_(std::move(control_points)),
      knot_s_(knot_s),
      duration_s_(knot_s * (static_cast<double>(points_.size()) - 6.0)) {}

void Motion::evaluate(double t_s, int derivatives, Channels (&out)[3]) const {
  const double place = std::clamp(t_s, 0.0, duration_s_) / knot_s_;
  const std::size_t first = std::min(static_cast<std::size_t>(place), points_.size() - 6);
  const double u = place - static_cast<double>(first);
  double scale = 1.0;
  for (int order = 0; order <= derivatives; ++order, scale /= knot_s_) {
    const std::array<double, 6> w = weights(u, order);
    for (std::size_t channel = 0; channel < 6; ++channel) {
      double sum = 0.0;
      for (std::size_t i = 0; i < 6; ++i) {
        sum += w[i] * points_[first + i][channel];
      }
      out[order][channel] = scale * sum;
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

}  // namespace slamd::simulate
