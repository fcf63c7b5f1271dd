#include "core/graph/back_end.hpp"

#include <algorithm>

#include <Eigen/LU>

#include "core/base/assert.hpp"

namespace slamd::graph {

using geometry::Matrix6d;
using geometry::Se3;

namespace {

constexpr std::size_t kRecentLoops = 16;  // accepted ones that may support a pending one
constexpr int kFixRounds = 3;

/// No registration and no motion is believed to be better than this.
constexpr double kFinest_m = 1e-4;
constexpr double kFinest_rad = 1e-5;

BetweenFactor factor_of(const Motion& motion) {
  Matrix6d covariance = motion.covariance;
  covariance.diagonal().head<3>().array() += kFinest_m * kFinest_m;
  covariance.diagonal().tail<3>().array() += kFinest_rad * kFinest_rad;
  const Matrix6d information = covariance.inverse();
  return {motion.T_a_b, 0.5 * (information + information.transpose())};
}

Motion motion_of(const BetweenFactor& factor) {
  return {factor.T_a_b, factor.information.inverse()};
}

}  // namespace

BackEnd::BackEnd(const BackEndConfig& config)
    : config_(config),
      graph_(config.capacity),
      chain_(config.capacity.keyframes),
      optimiser_(PoseGraph::equations_capacity(config.capacity, config.factor_entries)),
      gnc_(config.capacity, config.gnc),
      pending_(config.pending_loops),
      before_(config.capacity),
      judged_(config.capacity),
      was_active_(config.capacity.loops),
      vertices_(config.pending_loops + kRecentLoops),
      supporting_(config.pending_loops + kRecentLoops),
      events_(config.capacity.loops + 2 * config.pending_loops) {
  SLAMD_ASSERT(config.pending_loops + kRecentLoops <= kMaxCliqueVertices);
}

bool BackEnd::add_keyframe(KeyframeId id,
                           const Se3& T_odom_base,
                           const Matrix6d& motion_covariance,
                           const std::optional<GravityFactor>& gravity) {
  if (graph_.full()) {
    return false;
  }
  chain_.push_back(T_odom_base, motion_covariance);
  const std::size_t i = graph_.size();
  if (i == 0) {
    graph_.add_keyframe(id, T_odom_base, {});
    PriorFactor anchor{T_odom_base, anchor_information()};
    if (!gravity) {
      anchor.information.diagonal()[3] = anchor.information.diagonal()[4] = anchor.information.diagonal()[5];
    }
    graph_.add_prior(id, anchor);
  } else {
    const Motion motion = chain_.between(i - 1, i);
    graph_.add_keyframe(id, graph_.node(i - 1).T_map_base * motion.T_a_b, factor_of(motion));
  }
  if (gravity) {
    graph_.set_gravity(i, *gravity);
  }
  return true;
}

void BackEnd::add_fix(KeyframeId id, const GnssFactor& fix) {
  graph_.set_fix(graph_.index_of(id), fix);
  new_fixes_from_ = std::min(id, new_fixes_from_.value_or(id));
  ++fixes_waiting_;
}

ChainLoop BackEnd::in_chain(KeyframeId a, KeyframeId b, const Motion& motion) const {
  return {graph_.index_of(a), graph_.index_of(b), motion};
}

Proposal BackEnd::propose(const LoopCandidate& candidate, LoopId& id) {
  SLAMD_ASSERT(candidate.a < candidate.b);
  id = next_loop_++;
  if (pending_.full()) {
    return Proposal::kPendingFull;
  }
  if (!graph_.holds(candidate.a) || !graph_.holds(candidate.b)) {
    return Proposal::kNoKeyframe;
  }
  if (is_known(candidate.a, candidate.b)) {
    return Proposal::kKnownPair;
  }
  const CycleError error = odometry_cycle(chain_, in_chain(candidate.a, candidate.b, candidate.motion));
  if (!(error.chi_squared >= 0.0 && error.chi_squared <= config_.cycle_chi_squared)) {  // nor if its covariance is none
    return Proposal::kContradictsOdometry;
  }
  pending_.push_back({id, candidate});
  return Proposal::kPending;
}

bool BackEnd::is_known(KeyframeId a, KeyframeId b) const {
  for (std::size_t k = 0; k < graph_.loops(); ++k) {
    if (graph_.loop(k).enabled && graph_.loop(k).a == a && graph_.loop(k).b == b) {
      return true;
    }
  }
  return std::any_of(pending_.begin(), pending_.end(), [&](const Pending& p) { return p.candidate.a == a && p.candidate.b == b; });
}

Se3 BackEnd::T_map_odom() const {
  const std::size_t newest = graph_.size() - 1;
  return graph_.node(newest).T_map_base * chain_.T_odom_base(newest).inverse();
}

void BackEnd::join_consistent() {
  vertices_.clear();
  for (const Pending& pending : pending_) {
    vertices_.push_back(in_chain(pending.candidate.a, pending.candidate.b, pending.candidate.motion));
  }
  std::size_t recent = 0;
  for (std::size_t k = graph_.loops(); k-- > 0 && recent < kRecentLoops;) {
    const Loop& loop = graph_.loop(k);
    if (loop.enabled) {
      vertices_.push_back(in_chain(loop.a, loop.b, motion_of(loop.factor)));
      ++recent;
    }
  }
  cliques_.reset(vertices_.size());
  supporting_.resize(0);
  supporting_.resize(vertices_.size());
  for (std::size_t u = 0; u < vertices_.size(); ++u) {
    for (std::size_t v = 0; v < u; ++v) {
      if (v >= pending_.size()) {
        cliques_.join(u, v);  // the graph holds both
        continue;
      }
      const CycleError error = pair_cycle(chain_, vertices_[v], vertices_[u]);
      if (error.chi_squared <= config_.cycle_chi_squared) {
        cliques_.join(u, v);
        supporting_[u][v] = supporting_[v][u] = error.position_std_m <= config_.supporting_std_m;
      }
    }
  }
}

void BackEnd::make_room() {
  for (std::size_t k = 0; graph_.loops_full() && k < graph_.loops(); ++k) {
    if (!graph_.loop(k).enabled) {
      graph_.remove_loop(graph_.loop(k).id);
    }
  }
}

bool BackEnd::let_in(const Pending& pending) {
  make_room();
  const bool room = graph_.add_loop(
      {pending.id, pending.candidate.a, pending.candidate.b, factor_of(pending.candidate.motion), 1.0, true});
  tell(pending.id, room ? LoopVerdict::kAccepted : LoopVerdict::kNoRoom);
  return room;
}

std::size_t BackEnd::let_supported_in() {
  if (pending_.empty()) {
    return 0;
  }
  join_consistent();
  const VertexSet clique = cliques_.find().vertices;
  std::size_t entered = 0;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < pending_.size(); ++k) {
    const bool supported = clique[k] && (supporting_[k] & clique).count() >= config_.supporters;
    if (supported || (pending_[k].candidate.strong && clique[k])) {
      entered += let_in(pending_[k]) ? 1 : 0;
    } else {
      pending_[kept++] = pending_[k];
    }
  }
  pending_.resize(kept);
  return entered;
}

void BackEnd::give_up_the_old() {
  const std::size_t newest = graph_.size() - 1;
  Pending* kept = std::remove_if(pending_.begin(), pending_.end(), [&](const Pending& pending) {
    const bool old = newest - graph_.index_of(pending.candidate.b) > config_.pending_keyframes;
    if (old) {
      tell(pending.id, LoopVerdict::kGivenUp);
    }
    return old;
  });
  pending_.resize(static_cast<std::size_t>(kept - pending_.begin()));
}

bool BackEnd::loops_agree() const {
  for (std::size_t k = 0; k < graph_.loops(); ++k) {
    if (graph_.loop(k).enabled && !(graph_.loop_chi_squared(k) <= config_.gnc.loop_chi_squared)) {
      return false;
    }
  }
  return true;
}

void BackEnd::solve_warm(Update& update) {
  update.kind = UpdateKind::kWarm;
  for (int round = 0; round < kFixRounds; ++round) {
    const OptimiserResult result = optimiser_.run(graph_, config_.limits);
    update.iterations += result.iterations;
    update.end = result.end;
    if (result.end == OptimiserEnd::kFactorTooLarge || gnc_.judge_fixes(graph_) == 0) {
      break;
    }
  }
}

void BackEnd::judge_all_loops() {
  for (std::size_t k = 0; k < graph_.loops(); ++k) {
    graph_.set_loop_enabled(k, true);
  }
  if (!optimiser_.prepare(graph_)) {
    // With those that were taken out before it does not fit: the others are judged alone.
    for (std::size_t k = 0; k < graph_.loops(); ++k) {
      graph_.set_loop_enabled(k, was_active_[k]);
    }
  }
}

void BackEnd::solve_full(Update& update) {
  was_active_.resize(graph_.loops());
  for (std::size_t k = 0; k < graph_.loops(); ++k) {
    was_active_[k] = graph_.loop(k).enabled;
  }
  judge_all_loops();
  const GncResult anew = gnc_.run(graph_, optimiser_, config_.limits);
  graph_.save(judged_);
  graph_.put_back(before_);
  judge_all_loops();
  const GncResult from_before = gnc_.settle(graph_, optimiser_, config_.limits);
  if (anew.cost < from_before.cost) {
    graph_.put_back(judged_);
  }
  update.kind = UpdateKind::kFull;
  update.iterations += anew.iterations + from_before.iterations;
  update.end = anew.cost < from_before.cost ? anew.end : from_before.end;
  for (std::size_t k = 0; k < graph_.loops(); ++k) {
    const bool active = graph_.loop(k).enabled;
    if (active != was_active_[k]) {
      tell(graph_.loop(k).id, active ? LoopVerdict::kTakenBack : LoopVerdict::kTakenOut);
    }
  }
}

void BackEnd::take_back_what_does_not_fit(std::size_t entered) {
  for (std::size_t k = 0; k < entered; ++k) {
    graph_.remove_loop(graph_.loop(graph_.loops() - 1).id);
  }
  for (LoopEvent& event : events_) {
    event.verdict = event.verdict == LoopVerdict::kAccepted ? LoopVerdict::kNoRoom : event.verdict;
  }
}

bool BackEnd::new_fixes_disagree() const {
  std::size_t doubted = 0;
  std::size_t seen = 0;
  for (std::size_t i = graph_.first_at_or_after(new_fixes_from_.value_or(0)); i < graph_.size(); ++i) {
    if (graph_.node(i).fix) {
      ++seen;
      doubted += graph_.node(i).fix_weight > 0.0 ? 0 : 1;
    }
  }
  return 2 * doubted > seen;
}

Update BackEnd::update() {
  events_.clear();
  Update update;
  if (graph_.size() < 2) {
    return update;
  }
  const std::size_t entered = let_supported_in();
  give_up_the_old();
  const bool enough_fixes = fixes_waiting_ >= config_.fixes_per_update;
  const bool was_aligned = graph_.alignment().has_value();
  if (enough_fixes && !was_aligned) {
    gnc_.align(graph_, config_.least_extent_m, config_.greatest_yaw_std_rad);
  }
  const bool aligned = graph_.alignment().has_value();
  if (entered > 0 || (enough_fixes && aligned)) {
    graph_.save(before_);
    solve_warm(update);
    if (update.end == OptimiserEnd::kFactorTooLarge) {
      take_back_what_does_not_fit(entered);
      update.kind = UpdateKind::kNone;
    } else if (!loops_agree() || aligned != was_aligned || (enough_fixes && new_fixes_disagree())) {
      solve_full(update);
    }
  }
  if (enough_fixes) {
    fixes_waiting_ = 0;
    new_fixes_from_.reset();
  }
  update.loops = {events_.data(), events_.size()};
  return update;
}

Motion BackEnd::moved(const Motion& motion, KeyframeId& a, KeyframeId& b, std::size_t retired) const {
  const KeyframeId next = graph_.node(retired + 1).id;
  if (b == graph_.node(retired).id) {
    b = next;
    return composed(motion, chain_.between(retired, retired + 1));
  }
  if (b != next) {
    a = next;
    return composed(inverse(chain_.between(retired, retired + 1)), motion);
  }
  a = graph_.node(retired - 1).id;
  return composed(chain_.between(retired - 1, retired), motion);
}

void BackEnd::retire(KeyframeId id) {
  const std::size_t i = graph_.index_of(id);
  SLAMD_ASSERT(i > 0 && i + 1 < graph_.size());
  for (std::size_t k = 0; k < graph_.loops(); ++k) {
    KeyframeId a = graph_.loop(k).a;
    KeyframeId b = graph_.loop(k).b;
    if (a == id || b == id) {
      const Motion motion = moved(motion_of(graph_.loop(k).factor), a, b, i);
      graph_.move_loop(k, a, b, factor_of(motion));
    }
  }
  for (Pending& pending : pending_) {
    LoopCandidate& candidate = pending.candidate;
    if (candidate.a == id || candidate.b == id) {
      candidate.motion = moved(candidate.motion, candidate.a, candidate.b, i);
    }
  }
  if (graph_.node(i).fix) {
    GnssFactor fix = *graph_.node(i).fix;
    fix.p_base_antenna = chain_.between(i, i + 1).T_a_b.inverse() * fix.p_base_antenna;
    graph_.set_fix(i + 1, fix);
  }
  chain_.erase(i);
  graph_.remove_keyframe(i, factor_of(chain_.between(i - 1, i)));
}

}  // namespace slamd::graph
