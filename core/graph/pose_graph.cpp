#include "core/graph/pose_graph.hpp"

#include <algorithm>

#include "core/base/assert.hpp"

namespace slamd::graph {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

namespace {

/// Keeps the alignment's block positive where no fix with weight, or none with a height, holds it. It damps a step; the
/// optimum stays, for the gradient has no such part.
constexpr double kAlignmentDamping = 1e-6;

/// Writes a factor between two poses.
void write_between(NormalEquations& equations,
                   std::size_t coupling,
                   std::pair<std::size_t, std::size_t> blocks,
                   const BetweenLinearised& at,
                   const Matrix6d& information) {
  const Matrix6d W_a = information * at.J_a;
  const Matrix6d W_b = information * at.J_b;
  equations.add_diagonal(blocks.first, (at.J_a.transpose() * W_a).eval());
  equations.add_diagonal(blocks.second, (at.J_b.transpose() * W_b).eval());
  equations.add_coupling(coupling, (at.J_a.transpose() * W_b).eval());
  equations.add_gradient(blocks.first, (-W_a.transpose() * at.residual).eval());
  equations.add_gradient(blocks.second, (-W_b.transpose() * at.residual).eval());
}

double weighted_square(const Vector6d& r, const Matrix6d& information) {
  return r.dot(information * r);
}

double weighted_square(const GnssFactor& fix, const Eigen::Vector3d& r) {
  return r.cwiseAbs2().dot(fix.information_diagonal());
}

}  // namespace

PoseGraph::PoseGraph(const PoseGraphCapacity& capacity)
    : nodes_(capacity.keyframes), loops_(capacity.loops), priors_(capacity.priors), kept_poses_(capacity.keyframes) {}

NormalEquationsCapacity PoseGraph::equations_capacity(const PoseGraphCapacity& capacity, std::size_t factor_entries) {
  NormalEquationsCapacity out;
  out.blocks = capacity.keyframes + 1;
  out.couplings = 2 * capacity.keyframes + capacity.loops;  // odometry, fixes, loops
  out.factor_entries = factor_entries;
  return out;
}

bool PoseGraph::add_keyframe(KeyframeId id, const Se3& T_map_base, const BetweenFactor& odometry) {
  SLAMD_ASSERT(nodes_.empty() || id > nodes_.back().id);
  if (nodes_.full()) {
    return false;
  }
  nodes_.push_back({id, T_map_base, odometry, std::nullopt, std::nullopt, 1.0});
  ++structure_version_;
  return true;
}

bool PoseGraph::add_prior(KeyframeId id, const PriorFactor& prior) {
  SLAMD_ASSERT(holds(id));
  return priors_.try_push_back({id, prior});
}

bool PoseGraph::add_loop(const Loop& loop) {
  SLAMD_ASSERT(loop.a < loop.b && holds(loop.a) && holds(loop.b));
  if (!loops_.try_push_back(loop)) {
    return false;
  }
  ++structure_version_;
  return true;
}

void PoseGraph::remove_loop(LoopId id) {
  Loop* kept = std::remove_if(loops_.begin(), loops_.end(), [id](const Loop& loop) { return loop.id == id; });
  loops_.resize(static_cast<std::size_t>(kept - loops_.begin()));
  ++structure_version_;
}

void PoseGraph::set_fix(std::size_t index, const GnssFactor& fix) {
  Node& node = nodes_[index];
  if (node.fix && node.fix->horizontal_std_m <= fix.horizontal_std_m) {
    return;
  }
  fixes_ += node.fix ? 0 : 1;
  node.fix = fix;
  node.fix_weight = 1.0;
  ++structure_version_;
}

void PoseGraph::remove_keyframe(std::size_t index, const BetweenFactor& odometry) {
  SLAMD_ASSERT(index > 0 && index + 1 < nodes_.size());
  for (const Prior& prior : priors_) {
    SLAMD_ASSERT(prior.keyframe != nodes_[index].id);
  }
  for (const Loop& loop : loops_) {
    SLAMD_ASSERT(loop.a != nodes_[index].id && loop.b != nodes_[index].id);
  }
  fixes_ -= nodes_[index].fix ? 1 : 0;
  std::move(nodes_.begin() + index + 1, nodes_.end(), nodes_.begin() + index);
  nodes_.resize(nodes_.size() - 1);
  nodes_[index].odometry = odometry;
  ++structure_version_;
}

void PoseGraph::move_loop(std::size_t loop, KeyframeId a, KeyframeId b, const BetweenFactor& factor) {
  SLAMD_ASSERT(a < b && holds(a) && holds(b));
  loops_[loop].a = a;
  loops_[loop].b = b;
  loops_[loop].factor = factor;
  ++structure_version_;
}

void PoseGraph::set_alignment(const GnssAlignment& alignment) {
  structure_version_ += alignment_ ? 0 : 1;
  alignment_ = alignment;
}

std::size_t PoseGraph::first_at_or_after(KeyframeId id) const {
  const Node* at = std::lower_bound(nodes_.begin(), nodes_.end(), id, [](const Node& n, KeyframeId k) { return n.id < k; });
  return static_cast<std::size_t>(at - nodes_.begin());
}

std::size_t PoseGraph::index_of(KeyframeId id) const {
  const std::size_t i = first_at_or_after(id);
  SLAMD_ASSERT(i < nodes_.size() && nodes_[i].id == id);
  return i;
}

bool PoseGraph::holds(KeyframeId id) const {
  const std::size_t i = first_at_or_after(id);
  return i < nodes_.size() && nodes_[i].id == id;
}

void PoseGraph::set_loop_enabled(std::size_t k, bool enabled) {
  structure_version_ += loops_[k].enabled == enabled ? 0 : 1;
  loops_[k].enabled = enabled;
}

double PoseGraph::loop_chi_squared(std::size_t k) const {
  const Loop& loop = loops_[k];
  return weighted_square(
      residual_of(loop.factor, nodes_[index_of(loop.a)].T_map_base, nodes_[index_of(loop.b)].T_map_base),
      loop.factor.information);
}

double PoseGraph::fix_chi_squared(std::size_t index) const {
  const Node& node = nodes_[index];
  return weighted_square(*node.fix, residual_of(*node.fix, node.T_map_base, *alignment_));
}

void PoseGraph::unroll_odometry() {
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    nodes_[i].T_map_base = nodes_[i - 1].T_map_base * nodes_[i].odometry.T_a_b;
  }
}

void PoseGraph::save(GraphState& state) const {
  state.poses_.resize(nodes_.size());
  state.fix_weights_.resize(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    state.poses_[i] = nodes_[i].T_map_base;
    state.fix_weights_[i] = nodes_[i].fix_weight;
  }
  state.loop_weights_.resize(loops_.size());
  state.loops_enabled_.resize(loops_.size());
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    state.loop_weights_[k] = loops_[k].weight;
    state.loops_enabled_[k] = loops_[k].enabled;
  }
  state.alignment_ = alignment_;
}

void PoseGraph::put_back(const GraphState& state) {
  SLAMD_ASSERT(state.poses_.size() == nodes_.size() && state.loop_weights_.size() == loops_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    nodes_[i].T_map_base = state.poses_[i];
    nodes_[i].fix_weight = state.fix_weights_[i];
  }
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    loops_[k].weight = state.loop_weights_[k];
    set_loop_enabled(k, state.loops_enabled_[k] != 0);
  }
  structure_version_ += alignment_.has_value() == state.alignment_.has_value() ? 0 : 1;
  alignment_ = state.alignment_;
}

void PoseGraph::declare(NormalEquations& equations) const {
  equations.clear_structure();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    equations.add_block(6);
  }
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    equations.couple(i - 1, i);
  }
  for (const Loop& loop : loops_) {
    if (loop.enabled) {
      equations.couple(index_of(loop.a), index_of(loop.b));
    }
  }
  if (is_aligned()) {
    const std::size_t alignment = equations.add_block(4);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].fix) {
        equations.couple(i, alignment);
      }
    }
  }
}

double PoseGraph::linearise(NormalEquations& equations) const {
  equations.clear_values();
  double sum = 0.0;
  std::size_t coupling = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (i > 0) {
      const BetweenLinearised at = graph::linearise(node.odometry, nodes_[i - 1].T_map_base, node.T_map_base);
      write_between(equations, coupling++, {i - 1, i}, at, node.odometry.information);
      sum += weighted_square(at.residual, node.odometry.information);
    }
    if (node.gravity) {
      const GravityLinearised at = graph::linearise(*node.gravity, node.T_map_base);
      const double information = 1.0 / (node.gravity->std_rad * node.gravity->std_rad);
      Matrix6d H = Matrix6d::Zero();
      H.bottomRightCorner<3, 3>() = information * at.J_rotation.transpose() * at.J_rotation;
      Vector6d g = Vector6d::Zero();
      g.tail<3>() = -information * at.J_rotation.transpose() * at.residual;
      equations.add_diagonal(i, H);
      equations.add_gradient(i, g);
      sum += information * at.residual.squaredNorm();
    }
  }
  for (const Loop& loop : loops_) {
    if (loop.enabled) {
      const std::size_t a = index_of(loop.a);
      const std::size_t b = index_of(loop.b);
      const BetweenLinearised at = graph::linearise(loop.factor, nodes_[a].T_map_base, nodes_[b].T_map_base);
      write_between(equations, coupling++, {a, b}, at, loop.weight * loop.factor.information);
      sum += loop.weight * weighted_square(at.residual, loop.factor.information);
    }
  }
  for (const Prior& prior : priors_) {
    const std::size_t i = index_of(prior.keyframe);
    const PriorLinearised at = graph::linearise(prior.factor, nodes_[i].T_map_base);
    const Matrix6d W = prior.factor.information * at.J_pose;
    equations.add_diagonal(i, (at.J_pose.transpose() * W).eval());
    equations.add_gradient(i, (-W.transpose() * at.residual).eval());
    sum += weighted_square(at.residual, prior.factor.information);
  }
  if (is_aligned()) {
    const std::size_t block = nodes_.size();
    equations.add_diagonal(block, (kAlignmentDamping * Eigen::Matrix4d::Identity()).eval());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const Node& node = nodes_[i];
      if (!node.fix) {
        continue;
      }
      const GnssLinearised at = graph::linearise(*node.fix, node.T_map_base, *alignment_);
      const Eigen::Vector3d w = node.fix_weight * node.fix->information_diagonal();
      equations.add_diagonal(i, (at.J_pose.transpose() * w.asDiagonal() * at.J_pose).eval());
      equations.add_diagonal(block, (at.J_alignment.transpose() * w.asDiagonal() * at.J_alignment).eval());
      equations.add_coupling(coupling++, (at.J_pose.transpose() * w.asDiagonal() * at.J_alignment).eval());
      equations.add_gradient(i, (-at.J_pose.transpose() * w.cwiseProduct(at.residual)).eval());
      equations.add_gradient(block, (-at.J_alignment.transpose() * w.cwiseProduct(at.residual)).eval());
      sum += node.fix_weight * weighted_square(*node.fix, at.residual);
    }
  }
  return 0.5 * sum;
}

double PoseGraph::cost() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    if (i > 0) {
      sum += weighted_square(residual_of(node.odometry, nodes_[i - 1].T_map_base, node.T_map_base),
                             node.odometry.information);
    }
    if (node.gravity) {
      sum += residual_of(*node.gravity, node.T_map_base).squaredNorm() / (node.gravity->std_rad * node.gravity->std_rad);
    }
    if (node.fix && is_aligned()) {
      sum += node.fix_weight * fix_chi_squared(i);
    }
  }
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    if (loops_[k].enabled) {
      sum += loops_[k].weight * loop_chi_squared(k);
    }
  }
  for (const Prior& prior : priors_) {
    sum += weighted_square(residual_of(prior.factor, nodes_[index_of(prior.keyframe)].T_map_base),
                           prior.factor.information);
  }
  return 0.5 * sum;
}

std::pair<double, double> PoseGraph::move(const NormalEquations& equations) {
  kept_poses_.resize(nodes_.size());
  kept_alignment_ = alignment_;
  double step_m = 0.0;
  double step_rad = 0.0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    kept_poses_[i] = nodes_[i].T_map_base;
    const Vector6d step = equations.step<6>(i);
    nodes_[i].T_map_base = geometry::boxplus(nodes_[i].T_map_base, step);
    step_m = std::max(step_m, step.head<3>().cwiseAbs().maxCoeff());
    step_rad = std::max(step_rad, step.tail<3>().cwiseAbs().maxCoeff());
  }
  if (is_aligned()) {
    const Vector4d step = equations.step<4>(nodes_.size());
    alignment_ = boxplus(*alignment_, step);
    step_m = std::max(step_m, step.head<3>().cwiseAbs().maxCoeff());
    step_rad = std::max(step_rad, std::abs(step[3]));
  }
  return {step_m, step_rad};
}

void PoseGraph::restore() {
  SLAMD_ASSERT(kept_poses_.size() == nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    nodes_[i].T_map_base = kept_poses_[i];
  }
  alignment_ = kept_alignment_;
}

}  // namespace slamd::graph
