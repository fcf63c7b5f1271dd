#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/graph/between_factor.hpp"
#include "core/graph/gnss_factor.hpp"
#include "core/graph/graph_ids.hpp"
#include "core/graph/gravity_factor.hpp"
#include "core/graph/normal_equations.hpp"
#include "core/graph/prior_factor.hpp"

namespace slamd::graph {

/// The limits that all memory follows from.
struct PoseGraphCapacity {
  std::size_t keyframes = 10'000;
  std::size_t loops = 4'096;
  std::size_t priors = 16;
};

/// A keyframe's pose with the factors that belong to it alone or tie it to the one before.
struct Node {
  KeyframeId id = 0;
  geometry::Se3 T_map_base;
  BetweenFactor odometry;  // from the node before; meaningless at the first
  std::optional<GravityFactor> gravity;
  std::optional<GnssFactor> fix;
  double fix_weight = 1.0;  // 0 where it is held for an outlier
};

/// A loop: keyframe b seen from keyframe a, a < b.
struct Loop {
  LoopId id = 0;
  KeyframeId a = 0;
  KeyframeId b = 0;
  BetweenFactor factor;
  double weight = 1.0;   // 0 where it is held for wrong
  bool enabled = true;   // part of the equations' structure; one that is not costs nothing
};

/// What an estimate consists of: poses, alignment, and which loops and fixes it believes.
class GraphState {
 public:
  explicit GraphState(const PoseGraphCapacity& capacity)
      : poses_(capacity.keyframes), fix_weights_(capacity.keyframes), loop_weights_(capacity.loops), loops_enabled_(capacity.loops) {}

 private:
  friend class PoseGraph;

  BoundedVector<geometry::Se3> poses_;
  BoundedVector<double> fix_weights_;
  BoundedVector<double> loop_weights_;
  BoundedVector<std::uint8_t> loops_enabled_;
  std::optional<GnssAlignment> alignment_;
};

/// Poses of keyframes in map, and what is known of them. The sum it has the least of is
/// ½ Σ w rᵀ Ω r over odometry, gravity, priors (w = 1), loops and fixes (w as graduated non-convexity has set it).
/// Memory: sized once, by the capacity; what does not fit is refused by the call's result.
/// Indices run along the way and change when a keyframe is retired; ids do not.
class PoseGraph {
 public:
  explicit PoseGraph(const PoseGraphCapacity& capacity);

  /// Returns the sizes of normal equations that hold any such graph.
  static NormalEquationsCapacity equations_capacity(const PoseGraphCapacity& capacity, std::size_t factor_entries);

  /// Appends a keyframe, its id greater than all before. Returns false where the graph is full.
  bool add_keyframe(KeyframeId id, const geometry::Se3& T_map_base, const BetweenFactor& odometry);

  /// Ties a pose to a known one. Returns false where there is no room.
  bool add_prior(KeyframeId id, const PriorFactor& prior);

  /// Returns false where there is no room.
  bool add_loop(const Loop& loop);

  void remove_loop(LoopId id);

  /// Gives a keyframe its one fix; where it has one, the more certain stays.
  void set_fix(std::size_t index, const GnssFactor& fix);

  /// Takes a keyframe that is neither first nor last out: `odometry` then leads from the one before it to the one after
  /// it. Its loops must have been moved (move_loop), its gravity and fix go with it.
  void remove_keyframe(std::size_t index, const BetweenFactor& odometry);

  /// Hangs a loop on other keyframes, with the same evidence.
  void move_loop(std::size_t loop, KeyframeId a, KeyframeId b, const BetweenFactor& factor);

  /// Begins to estimate how the receiver's axes lie in the map; without it fixes count for nothing.
  void set_alignment(const GnssAlignment& alignment);

  std::size_t size() const { return nodes_.size(); }
  bool full() const { return nodes_.full(); }
  const Node& node(std::size_t index) const { return nodes_[index]; }
  /// Where the first keyframe stands that is no older than `id`; size() if there is none.
  std::size_t first_at_or_after(KeyframeId id) const;
  std::size_t index_of(KeyframeId id) const;
  bool holds(KeyframeId id) const;
  const std::optional<GnssAlignment>& alignment() const { return alignment_; }
  std::size_t fixes() const { return fixes_; }

  std::size_t loops() const { return loops_.size(); }
  bool loops_full() const { return loops_.full(); }
  const Loop& loop(std::size_t k) const { return loops_[k]; }
  std::size_t priors() const { return priors_.size(); }
  const PriorFactor& prior(std::size_t k) const { return priors_[k].factor; }
  KeyframeId prior_keyframe(std::size_t k) const { return priors_[k].keyframe; }

  void set_pose(std::size_t index, const geometry::Se3& T_map_base) { nodes_[index].T_map_base = T_map_base; }
  void set_gravity(std::size_t index, const GravityFactor& gravity) { nodes_[index].gravity = gravity; }
  void set_fix_weight(std::size_t index, double weight) { nodes_[index].fix_weight = weight; }
  void set_loop_weight(std::size_t k, double weight) { loops_[k].weight = weight; }
  void set_loop_enabled(std::size_t k, bool enabled);

  /// Returns rᵀ Ω r. Without dimension.
  double loop_chi_squared(std::size_t k) const;
  double fix_chi_squared(std::size_t index) const;

  /// Lays the poses out anew from the first one along the odometry.
  void unroll_odometry();

  /// Copies the estimate out, and back in while keyframes and loops are still the same.
  void save(GraphState& state) const;
  void put_back(const GraphState& state);

  /// Counts the changes of what is tied to what.
  std::uint64_t structure_version() const { return structure_version_; }

  /// Tells variables and couplings, in the order in which linearise writes them.
  void declare(NormalEquations& equations) const;

  /// Writes H and g = −Jᵀ Ω r at the present poses, and returns the sum.
  double linearise(NormalEquations& equations) const;

  /// Returns the sum at the present poses.
  double cost() const;

  /// Keeps the poses for restore, and moves them by the solution. Returns the greatest |δp| and |δθ| of an axis; m, rad.
  std::pair<double, double> move(const NormalEquations& equations);
  void restore();

 private:
  struct Prior {
    KeyframeId keyframe = 0;
    PriorFactor factor;
  };

  bool is_aligned() const { return alignment_.has_value() && fixes_ > 0; }

  BoundedVector<Node> nodes_;
  BoundedVector<Loop> loops_;
  BoundedVector<Prior> priors_;
  std::optional<GnssAlignment> alignment_;
  std::size_t fixes_ = 0;
  std::uint64_t structure_version_ = 1;

  // scratch, sized once
  BoundedVector<geometry::Se3> kept_poses_;
  std::optional<GnssAlignment> kept_alignment_;
};

}  // namespace slamd::graph
