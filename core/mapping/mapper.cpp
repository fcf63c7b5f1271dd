#include "core/mapping/mapper.hpp"

#include <algorithm>

namespace slamd::mapping {

using geometry::Se3;
using graph::KeyframeId;

namespace {

constexpr std::size_t kMostProposals = 8;

/// A vehicle that stands goes no way, however its pose trembles.
constexpr double kCountedStep_m = 0.1;

/// What a motion over lost scans may be wrong by: m a metre, and rad.
constexpr double kGapShare = 0.05;

/// So well the filter knows the vertical after the first bends; before, by some ten milliradians.
constexpr double kKnownVertical_rad = 0.001;

graph::BackEndConfig with_capacity(const MapperConfig& config) {
  graph::BackEndConfig back_end = config.back_end;
  back_end.capacity.keyframes = config.keyframes;
  back_end.capacity.loops = config.loops;
  return back_end;
}

}  // namespace

Mapper::Mapper(const MapperConfig& config)
    : config_(config),
      back_end_(with_capacity(config)),
      keyframes_(config.keyframes, config.points_a_cloud),
      uncertainty_(config.keyframes, config.loops),
      appearance_(config.use_loop_net ? std::make_optional<Appearance>(config.keyframes) : std::nullopt),
      submaps_(config.keyframes, config.submap_m),
      cloud_(config.gathered_points),
      verifier_(config.verification),
      submap_points_((2 * config.neighbours + 1) * config.points_a_cloud),
      query_points_(config.points_a_cloud),
      proposals_(kMostProposals),
      trials_(kMostProposals) {}

// The whole of mapping, a line a step.
MapperUpdate Mapper::process(const MappedScan& scan) {
  follow(scan);
  if (!scan.trusted) {
    return {};
  }
  Place place{scan.stamp, T_map_odom_ * scan.T_odom_base, std::nullopt, path_m_, scan.indoor};
  if (open_ || !keyframes_.empty()) {
    place.T_last_base = T_odom_newest_.inverse() * scan.T_odom_base;
  }
  const Novelty novelty = novelty_of(place, config_.novelty, keyframes_, uncertainty_,
                                     [this](std::size_t i) -> const Se3& { return T_map_base(i); });
  MapperUpdate update;
  if (open_ && (novelty != Novelty::kNone || open_->scans >= config_.scans_a_cloud)) {
    update = close_keyframe();
  }
  if (novelty != Novelty::kNone) {
    begin_keyframe(scan);
  }
  gather(scan);
  return update;
}

MapperUpdate Mapper::finish() { return open_ ? close_keyframe() : MapperUpdate{}; }

void Mapper::restart() {
  back_end_.emplace(with_capacity(config_));
  keyframes_.clear();
  if (appearance_) {
    appearance_->clear();
  }
  submaps_.clear();
  path_m_ = 0.0;
  any_scan_ = false;
  since_keyframe_.reset();
  next_id_ = 0;
  open_.reset();
  correction_id_ += correction_id_ > 0 ? 1 : 0;
  T_map_odom_ = Se3();
  last_loop_path_m_.reset();
  submap_of_.reset();
  counts_ = {};
  retired_ = 0;
}

void Mapper::follow(const MappedScan& scan) {
  const double moved_m = (scan.T_odom_base.translation() - T_odom_last_.translation()).norm();
  if (!any_scan_ || moved_m >= kCountedStep_m) {
    path_m_ += any_scan_ ? moved_m : 0.0;
    T_odom_last_ = scan.T_odom_base;
    any_scan_ = true;
  }
  has_gap_ = has_gap_ || scan.after_gap;
  if (since_keyframe_) {
    since_keyframe_->add(scan.motion);
  }
}

void Mapper::begin_keyframe(const MappedScan& scan) {
  Open open;
  open.keyframe.id = next_id_++;
  open.keyframe.stamp = scan.stamp;
  open.keyframe.T_odom_base = scan.T_odom_base;
  open.keyframe.path_m = path_m_;
  open.indoor = scan.indoor;
  open.up_base = scan.T_odom_base.rotation().transpose() * scan.up_odom;
  open.up_std_rad = scan.up_std_rad;
  open.keyframe.R_base_level = level_of(open.up_base);
  if (since_keyframe_) {
    open.motion_covariance = since_keyframe_->covariance();
    if (has_gap_) {
      const double way_m = (scan.T_odom_base.translation() - T_odom_newest_.translation()).norm();
      open.motion_covariance.diagonal().head<3>().array() += kGapShare * kGapShare * (1.0 + way_m * way_m);
      open.motion_covariance.diagonal().tail<3>().array() += kGapShare * kGapShare;
    }
  }
  has_gap_ = false;
  since_keyframe_.emplace(scan.motion);
  T_odom_newest_ = scan.T_odom_base;
  cloud_.begin(scan.indoor ? config_.cloud_spacing_indoor_m : config_.cloud_spacing_outdoor_m);
  open_ = open;
}

void Mapper::gather(const MappedScan& scan) {
  if (!open_ || open_->scans >= config_.scans_a_cloud) {
    return;
  }
  const Keyframe& keyframe = open_->keyframe;
  const Se3 T_odom_level(keyframe.T_odom_base.rotation() * keyframe.R_base_level, keyframe.T_odom_base.translation());
  cloud_.add(scan.points_imu, T_odom_level.inverse() * scan.T_odom_imu);
  ++open_->scans;
}

MapperUpdate Mapper::close_keyframe() {
  MapperUpdate result;
  result.retired = make_room();
  Open& open = *open_;
  std::optional<graph::GravityFactor> gravity;
  // As long as the filter does not know the vertical well, keyframes that say so would bend the way: each says the same
  // wrong thing. The first must say something, or it would hold odom's own lean.
  if (config_.use_gravity && (keyframes_.empty() || open.up_std_rad <= kKnownVertical_rad)) {
    gravity = graph::GravityFactor{open.up_base, std::max(config_.gravity_caution * open.up_std_rad, config_.least_gravity_std_rad)};
  }
  trials_.clear();
  if (back_end_->add_keyframe(open.keyframe.id, open.keyframe.T_odom_base, open.motion_covariance, gravity)) {
    open.keyframe.median_range_m = cloud_.median_range_m();
    open.keyframe.submap = submaps_.add_keyframe(open.keyframe.id, open.keyframe.path_m, open.keyframe.T_odom_base, T_map_odom_);
    const auto points_level = cloud_.thinned(config_.points_a_cloud);
    keyframes_.add(open.keyframe, points_level);
    if (appearance_) {
      appearance_->add(open.keyframe.id, points_level);
    }
    result.keyframe_added = true;
    uncertainty_.look_from(*back_end_, keyframes_.size() - 1);
    propose();
    const graph::Update update = back_end_->update();
    for (const graph::LoopEvent& event : update.loops) {
      ++counts_.graph_verdicts[static_cast<std::size_t>(event.verdict)];
    }
    result.loops = update.loops;
    result.corrected = correct(update);
  }
  open_.reset();
  result.trials = trials_.view();
  return result;
}

std::optional<KeyframeId> Mapper::make_room() {
  if (!keyframes_.full()) {
    return std::nullopt;
  }
  const auto redundant = keyframes_.most_redundant(std::min(config_.kept_at_limit, config_.keyframes / 2),
                                                   [this](std::size_t i) -> const Se3& { return T_map_base(i); });
  if (!redundant) {
    return std::nullopt;
  }
  const Keyframe keyframe = keyframes_[*redundant];
  if (submap_of_ == keyframe.id) {
    submap_of_.reset();
  }
  back_end_->retire(keyframe.id);
  if (appearance_) {
    appearance_->remove(keyframe.id);
  }
  submaps_.remove_keyframe(keyframe.submap);
  keyframes_.erase(*redundant);
  ++retired_;
  return keyframe.id;
}

void Mapper::propose() {
  proposals_.clear();
  propose_by_place(keyframes_, uncertainty_, config_.proximity, [this](std::size_t i) -> const Se3& { return T_map_base(i); }, proposals_);
  if (appearance_) {
    appearance_->propose(keyframes_, uncertainty_, open_->indoor, config_.appearance, proposals_);
  }
  if (proposals_.empty()) {
    return;
  }
  const Keyframe& query = keyframes_.back();
  query_points_.clear();
  keyframes_.append_cloud(keyframes_.size() - 1, Se3(query.R_base_level, Eigen::Vector3d::Zero()), query_points_);
  for (const loop::LoopProposal& proposal : proposals_) {
    const bool is_quiet = last_loop_path_m_ && query.path_m - *last_loop_path_m_ < config_.quiet_m;
    if (!is_quiet || proposal.position_std_m > config_.certain_std_m) {
      try_loop(proposal);
    }
  }
}

void Mapper::try_loop(const loop::LoopProposal& proposal) {
  const Keyframe& candidate = keyframes_[proposal.keyframe];
  const Keyframe& query = keyframes_.back();
  gather_submap(proposal.keyframe);
  LoopTrial trial{candidate.id, query.id, candidate.stamp, query.stamp, proposal, verifier_.verify(query_points_.view(), proposal), {}, {}};
  ++counts_.candidates;
  ++counts_.verdicts[static_cast<std::size_t>(trial.verification.verdict)];
  if (trial.verification.verdict == loop::Verdict::kVerified) {
    const graph::Motion motion{trial.verification.T_candidate_query, trial.verification.covariance};
    trial.graph_says = back_end_->propose({candidate.id, query.id, motion, false}, trial.loop);
    ++counts_.proposed[static_cast<std::size_t>(trial.graph_says)];
    last_loop_path_m_ = query.path_m;
  }
  trials_.try_push_back(trial);
}

/// Joins the clouds around a candidate, in its base, by the way between them: what lies so near is known by the odometry.
void Mapper::gather_submap(std::size_t candidate) {
  if (submap_of_ == keyframes_[candidate].id) {
    return;
  }
  submap_of_ = keyframes_[candidate].id;
  submap_points_.clear();
  const Keyframe& middle = keyframes_[candidate];
  const auto append = [&](std::size_t i) {
    const Keyframe& keyframe = keyframes_[i];
    const Se3 T_odom_level(keyframe.T_odom_base.rotation() * keyframe.R_base_level, keyframe.T_odom_base.translation());
    keyframes_.append_cloud(i, middle.T_odom_base.inverse() * T_odom_level, submap_points_);
  };
  append(candidate);
  const std::size_t own = submap_points_.size();
  for (std::size_t k = 1; k <= config_.neighbours; ++k) {
    if (candidate >= k && middle.path_m - keyframes_[candidate - k].path_m <= config_.neighbours_m) {
      append(candidate - k);
    }
    if (candidate + k < keyframes_.size() && keyframes_[candidate + k].path_m - middle.path_m <= config_.neighbours_m) {
      append(candidate + k);
    }
  }
  verifier_.set_submap(submap_points_.view(), own);
}

Se3 Mapper::T_map_odom_at(KeyframeId id) const {
  const graph::PoseGraph& graph = back_end_->graph();
  const std::size_t i = std::min(graph.first_at_or_after(id), graph.size() - 1);
  return graph.node(i).T_map_base * back_end_->chain().T_odom_base(i).inverse();
}

bool Mapper::correct(const graph::Update& update) {
  if (update.kind == graph::UpdateKind::kNone) {
    return false;
  }
  ++correction_id_;
  T_map_odom_ = back_end_->T_map_odom();
  for (std::size_t i = 0; i < submaps_.size(); ++i) {
    submaps_.place(i, T_map_odom_at(submaps_[i].first_keyframe));
  }
  uncertainty_.look_from(*back_end_, keyframes_.size() - 1);
  return true;
}

std::vector<CorrectedKeyframe> Mapper::path() const {
  std::vector<CorrectedKeyframe> path;
  path.reserve(keyframes_.size());
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    path.push_back({keyframes_[i].stamp, keyframes_[i].T_odom_base, T_map_base(i)});
  }
  return path;
}

}  // namespace slamd::mapping
