#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/graph/back_end.hpp"

namespace slamd::mapping {

/// By how much each keyframe's place may be wrong as seen from one of them.
///
/// The covariance along the best way through the graph, over odometry and loops, is an upper bound of the marginal one: as
/// twists in map the errors of successive motions add up. Ways are found as Dijkstra does, by the greatest standard deviation
/// of the horizontal position at the keyframe itself.
/// Memory: sized once.  O((keyframes + loops) log keyframes), some 2 µs a keyframe.
class GraphUncertainty {
 public:
  GraphUncertainty(std::size_t keyframes, std::size_t loops);

  /// Looks at all keyframes from one.
  void look_from(const graph::BackEnd& back_end, std::size_t from);

  std::size_t size() const { return seen_.size(); }

  /// Of the horizontal position, in the worst direction at most.  Units: m.
  double position_std_m(std::size_t i) const { return seen_[i].position_std_m; }
  double height_std_m(std::size_t i) const { return seen_[i].height_std_m; }
  double yaw_std_rad(std::size_t i) const { return seen_[i].yaw_std_rad; }

 private:
  struct Seen {
    double position_std_m = 0.0;
    double height_std_m = 0.0;
    double yaw_std_rad = 0.0;
    bool is_settled = false;
    geometry::Matrix6d twist_map;  // of the way there
  };
  struct Tie {
    std::size_t from = 0;
    std::size_t to = 0;
    std::size_t loop = 0;
  };
  struct Visit {
    double position_std_m = 0.0;
    std::size_t keyframe = 0;
  };

  void gather_ties(const graph::PoseGraph& graph);
  void reach(std::size_t i, const graph::PoseGraph& graph, const geometry::Matrix6d& twist_map);
  static geometry::Matrix6d odometry_twist(const graph::BackEnd& back_end, std::size_t i);
  static geometry::Matrix6d loop_twist(const graph::PoseGraph& graph, std::size_t loop);

  BoundedVector<Seen> seen_;
  BoundedVector<Tie> ties_;     // scratch, sized once: each loop twice, by `from`
  std::vector<Visit> queue_;    // scratch, sized once: a heap
};

}  // namespace slamd::mapping
