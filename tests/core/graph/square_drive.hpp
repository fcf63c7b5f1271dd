#pragma once

#include <vector>

#include "core/graph/back_end.hpp"
#include "random_poses.hpp"

namespace slamd::graph {

/// A square of 20 m a side, a keyframe a metre, driven again and again: keyframe k + 80 stands where k stood.
/// The odometry turns a little too far at each step.
class SquareDrive {
 public:
  static constexpr std::size_t kRound = 80;

  explicit SquareDrive(std::size_t keyframes, double step_std_m = 0.01, double step_std_rad = 0.002)
      : step_covariance_(diagonal(step_std_m, step_std_rad)) {
    geometry::Vector6d wrong = geometry::Vector6d::Zero();
    wrong[5] = 0.5 * step_std_rad;
    T_world_base.emplace_back();
    T_odom_base.emplace_back();
    for (std::size_t i = 1; i < keyframes; ++i) {
      const geometry::Se3 turn(geometry::so3_exp({0.0, 0.0, i % 20 == 0 ? M_PI_2 : 0.0}), Eigen::Vector3d::Zero());
      const geometry::Se3 step = geometry::Se3(Eigen::Matrix3d::Identity(), {1.0, 0.0, 0.0}) * turn;
      T_world_base.push_back(T_world_base.back() * step);
      T_odom_base.push_back(T_odom_base.back() * boxplus(step, wrong));
    }
  }

  static geometry::Matrix6d diagonal(double std_m, double std_rad) {
    geometry::Vector6d d;
    d << Eigen::Vector3d::Constant(std_m * std_m), Eigen::Vector3d::Constant(std_rad * std_rad);
    return d.asDiagonal();
  }

  /// Gives the back end the keyframes from `first` to `end`. Returns how many it took.
  std::size_t drive(BackEnd& back_end, std::size_t first, std::size_t end) const {
    std::size_t taken = 0;
    for (std::size_t i = first; i < end; ++i) {
      const GravityFactor gravity{T_world_base[i].rotation().row(2).transpose(), 0.005};
      taken += back_end.add_keyframe(static_cast<KeyframeId>(i), T_odom_base[i], step_covariance_, gravity) ? 1 : 0;
    }
    return taken;
  }

  /// A loop that is off by `wrong` in the axes of its first keyframe.
  LoopCandidate loop(std::size_t a, std::size_t b, const Eigen::Vector3d& wrong = Eigen::Vector3d::Zero()) const {
    LoopCandidate out;
    out.a = static_cast<KeyframeId>(a);
    out.b = static_cast<KeyframeId>(b);
    out.motion.T_a_b = T_world_base[a].inverse() * T_world_base[b];
    out.motion.T_a_b.translation() += wrong;
    out.motion.covariance = diagonal(0.05, 0.005);
    return out;
  }

  /// The greatest distance of a pose from the truth. Units: m.
  double error(const PoseGraph& graph) const {
    double out = 0.0;
    for (std::size_t i = 0; i < graph.size(); ++i) {
      out = std::max(out, (graph.node(i).T_map_base.translation() - T_world_base[graph.node(i).id].translation()).norm());
    }
    return out;
  }

  std::vector<geometry::Se3> T_world_base;
  std::vector<geometry::Se3> T_odom_base;

 private:
  geometry::Matrix6d step_covariance_;
};

}  // namespace slamd::graph
