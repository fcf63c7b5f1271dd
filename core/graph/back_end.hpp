#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/graph/graduated_non_convexity.hpp"
#include "core/graph/loop_candidate.hpp"
#include "core/graph/maximum_clique.hpp"
#include "core/graph/odometry_chain.hpp"
#include "core/graph/optimiser.hpp"
#include "core/graph/pairwise_consistency.hpp"
#include "core/graph/pose_graph.hpp"

namespace slamd::graph {

/// Limits and thresholds of the back end.
struct BackEndConfig {
  PoseGraphCapacity capacity;
  std::size_t factor_entries = 6'000'000;  // of L: 12 bytes each

  // pairwise consistency
  std::size_t pending_loops = 128;
  std::size_t pending_keyframes = 200;             // a loop that nothing has supported for so long is given up
  double cycle_chi_squared = kChiSquared9999Of6;   // a cycle above it is a contradiction
  double supporting_std_m = 0.5;                   // a cycle less certain, which would let 3 m pass, supports nothing
  std::size_t supporters = 1;                      // that a loop needs in its clique, unless it is strong

  GncConfig gnc;
  OptimiserLimits limits;

  // fixes
  std::size_t fixes_per_update = 20;      // fewer new ones move nothing
  double least_extent_m = 10.0;           // of motion before the receiver's axes are aligned
  double greatest_yaw_std_rad = 0.09;     // that the motion must tell the yaw to: 5°
};

/// What became of a loop.
enum class LoopVerdict : std::uint8_t {
  kAccepted,   // it is in the graph
  kTakenOut,   // the graph disagrees with it: it counts for nothing from now on, and is judged again with the others
  kTakenBack,  // it agrees after all
  kGivenUp,    // nothing supported it in time
  kNoRoom,     // the graph or its factorisation is full
};

struct LoopEvent {
  LoopId id = 0;
  LoopVerdict verdict = LoopVerdict::kAccepted;
};

/// What became of a proposal at once.
enum class Proposal : std::uint8_t {
  kPending,              // waits for another loop to support it
  kContradictsOdometry,  // farther from the odometry than its covariance allows
  kPendingFull,          // as many loops wait as may
  kKnownPair,            // a loop of these two keyframes waits already, or is in the graph: it would support itself
  kNoKeyframe,           // one of them was retired
};

/// How an update came to its poses.
enum class UpdateKind : std::uint8_t {
  kNone,  // nothing new enough; no pose moved
  kWarm,  // from the poses as they were
  kFull,  // all loops and fixes judged anew
};

/// What an update did. The span is valid until the next one.
struct Update {
  UpdateKind kind = UpdateKind::kNone;
  OptimiserEnd end = OptimiserEnd::kConverged;
  int iterations = 0;
  std::span<const LoopEvent> loops;
};

/// The back end: keyframes, loops and fixes in, corrected poses out.
///
/// Loops wait until others support them, in one clique of consistent ones with the last that were accepted. What enters is
/// first believed: the graph is solved from where it stands (warm). If a loop, new or old, then disagrees, all are judged anew
/// by graduated non-convexity (full), those it has taken out before included, and the result is held against what the graph
/// said before the new ones came: the lower truncated sum stays. Odometry, gravity and priors are never doubted.
/// Frames: map is odom's frame at the first keyframe, until corrections move odom in it.
/// At the limits: a keyframe or a proposal that does not fit is refused by the result; a loop that does not fit into graph or
/// factorisation is reported as kNoRoom, and loops taken out make room for new ones. retire() makes room for keyframes.
/// Real-time: memory sized once, but for what NormalEquations says; mapping thread only.
class BackEnd {
 public:
  explicit BackEnd(const BackEndConfig& config);

  /// Appends a keyframe: its pose in odom, the covariance of the motion from the keyframe before as
  /// odometry::MotionCovariance has it (the first one's is ignored), and where up is. Returns false where the graph is full.
  bool add_keyframe(KeyframeId id,
                    const geometry::Se3& T_odom_base,
                    const geometry::Matrix6d& motion_covariance,
                    const std::optional<GravityFactor>& gravity);

  /// Gives a keyframe the position of the antenna at its time.
  void add_fix(KeyframeId id, const GnssFactor& fix);

  /// Offers a loop. Returns what became of it at once; `id` names it in what follows.
  Proposal propose(const LoopCandidate& candidate, LoopId& id);

  /// Lets the supported loops in and moves the poses.
  Update update();

  /// Takes a keyframe out that is neither first nor last: what was measured from it hangs on its neighbours from then on.
  void retire(KeyframeId id);

  const PoseGraph& graph() const { return graph_; }
  const OdometryChain& chain() const { return chain_; }
  const Optimiser& optimiser() const { return optimiser_; }
  std::size_t pending() const { return pending_.size(); }

  /// Returns where odom lies in the map, by the newest keyframe.
  geometry::Se3 T_map_odom() const;

 private:
  struct Pending {
    LoopId id = 0;
    LoopCandidate candidate;
  };

  bool is_known(KeyframeId a, KeyframeId b) const;
  ChainLoop in_chain(KeyframeId a, KeyframeId b, const Motion& motion) const;
  Motion moved(const Motion& motion, KeyframeId& a, KeyframeId& b, std::size_t retired) const;
  void tell(LoopId id, LoopVerdict verdict) { events_.try_push_back({id, verdict}); }
  void join_consistent();
  std::size_t let_supported_in();
  bool let_in(const Pending& pending);
  void make_room();
  void give_up_the_old();
  bool new_fixes_disagree() const;
  bool loops_agree() const;
  void solve_warm(Update& update);
  void solve_full(Update& update);
  void judge_all_loops();
  void take_back_what_does_not_fit(std::size_t entered);

  BackEndConfig config_;
  PoseGraph graph_;
  OdometryChain chain_;
  Optimiser optimiser_;
  GraduatedNonConvexity gnc_;
  MaximumClique cliques_;
  BoundedVector<Pending> pending_;
  LoopId next_loop_ = 0;
  std::size_t fixes_waiting_ = 0;
  std::optional<KeyframeId> new_fixes_from_;  // the first keyframe with a fix that no update has seen

  // scratch, sized once
  GraphState before_;  // the new loops came
  GraphState judged_;  // by graduated non-convexity
  BoundedVector<std::uint8_t> was_active_;
  BoundedVector<ChainLoop> vertices_;    // pending ones, then the last accepted ones
  BoundedVector<VertexSet> supporting_;  // of each vertex
  BoundedVector<LoopEvent> events_;
};

}  // namespace slamd::graph
