#include "core/mapping/graph_uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/geometry/so3.hpp"

namespace slamd::mapping {

using geometry::Matrix6d;
using geometry::Se3;

GraphUncertainty::GraphUncertainty(std::size_t keyframes, std::size_t loops)
    : seen_(keyframes), ties_(2 * loops) {
  queue_.reserve(2 * keyframes + 2 * loops);  // each way to a keyframe is offered once
}

void GraphUncertainty::gather_ties(const graph::PoseGraph& graph) {
  ties_.clear();
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    const graph::Loop& loop = graph.loop(k);
    if (loop.enabled && loop.weight > 0.5) {
      const std::size_t a = graph.index_of(loop.a);
      const std::size_t b = graph.index_of(loop.b);
      ties_.push_back({a, b, k});
      ties_.push_back({b, a, k});
    }
  }
  std::sort(ties_.begin(), ties_.end(),
            [](const Tie& x, const Tie& y) { return x.from < y.from || (x.from == y.from && x.loop < y.loop); });
}

Matrix6d GraphUncertainty::odometry_twist(const graph::BackEnd& back_end, std::size_t i) {
  const Matrix6d to_map = graph::adjoint(back_end.graph().node(i).T_map_base);
  return to_map * back_end.chain().spread(i, i + 1) * to_map.transpose();
}

Matrix6d GraphUncertainty::loop_twist(const graph::PoseGraph& graph, std::size_t loop) {
  const graph::BetweenFactor& factor = graph.loop(loop).factor;
  const Matrix6d to_map = graph::adjoint(graph.node(graph.index_of(graph.loop(loop).b)).T_map_base);
  return to_map * graph::right_twist_covariance({factor.T_a_b, factor.information.inverse()}) * to_map.transpose();
}

void GraphUncertainty::reach(std::size_t i, const graph::PoseGraph& graph, const Matrix6d& twist_map) {
  // A twist (v, ω) at map's origin moves what stands at p by v + ω × p.
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -geometry::skew(graph.node(i).T_map_base.translation());
  const Eigen::Matrix3d P = J * twist_map * J.transpose();
  const double position_std_m = std::sqrt(std::max(0.0, P(0, 0) + P(1, 1)));
  Seen& seen = seen_[i];
  if (seen.is_settled || !(position_std_m < seen.position_std_m)) {
    return;
  }
  seen.position_std_m = position_std_m;
  seen.height_std_m = std::sqrt(std::max(0.0, P(2, 2)));
  seen.yaw_std_rad = std::sqrt(std::max(0.0, twist_map(5, 5)));
  seen.twist_map = twist_map;
  queue_.push_back({position_std_m, i});
  std::push_heap(queue_.begin(), queue_.end(),
                 [](const Visit& x, const Visit& y) { return x.position_std_m > y.position_std_m; });
}

void GraphUncertainty::look_from(const graph::BackEnd& back_end, std::size_t from) {
  const graph::PoseGraph& graph = back_end.graph();
  gather_ties(graph);
  seen_.resize(0);
  seen_.resize(graph.size());
  for (Seen& seen : seen_) {
    seen.position_std_m = std::numeric_limits<double>::infinity();
  }
  queue_.clear();
  reach(from, graph, Matrix6d::Zero());
  while (!queue_.empty()) {
    const std::size_t i = queue_[0].keyframe;
    std::pop_heap(queue_.begin(), queue_.end(),
                  [](const Visit& x, const Visit& y) { return x.position_std_m > y.position_std_m; });
    queue_.pop_back();
    if (seen_[i].is_settled) {
      continue;
    }
    seen_[i].is_settled = true;
    const Matrix6d twist_map = seen_[i].twist_map;
    if (i > 0 && !seen_[i - 1].is_settled) {
      reach(i - 1, graph, twist_map + odometry_twist(back_end, i - 1));
    }
    if (i + 1 < graph.size() && !seen_[i + 1].is_settled) {
      reach(i + 1, graph, twist_map + odometry_twist(back_end, i));
    }
    const Tie* tie = std::lower_bound(ties_.begin(), ties_.end(), i, [](const Tie& t, std::size_t key) { return t.from < key; });
    for (; tie != ties_.end() && tie->from == i; ++tie) {
      if (!seen_[tie->to].is_settled) {
        reach(tie->to, graph, twist_map + loop_twist(graph, tie->loop));
      }
    }
  }
}

}  // namespace slamd::mapping
