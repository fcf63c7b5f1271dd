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
