#include "core/loop/verification.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/geometry/so3.hpp"
#include "core/odometry/localisability.hpp"
#include "core/registration/gauss_newton.hpp"

namespace slamd::loop {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

namespace {

constexpr double kTruncation = 4.5;  // of r²/2σ²: at 3σ
constexpr int kAssociations = 4;
constexpr int kModeAssociations = 4;
constexpr int kStepsAnAssociation = 2;

registration::GaussNewtonConfig refining() {
  registration::GaussNewtonConfig config;
  config.iterations = 14;
  config.coarse_iterations = 6;
  config.gate_first_m = 1.5F;
  config.gate_last_m = 0.4F;
  return config;
}

scan::PreprocessConfig features_only(std::size_t points) {
  scan::PreprocessConfig config;
  config.max_planar = points;
  config.max_edge = 0;
  config.max_map_points = 0;
  return config;
}

/// Takes `wanted` points out of a cloud, evenly.
void take_evenly(std::span<const Eigen::Vector3f> points, BoundedVector<Eigen::Vector3f>& out) {
  out.clear();
  const std::size_t wanted = std::min(points.size(), out.capacity());
  for (std::size_t k = 0; k < wanted; ++k) {
    out.push_back(points[k * points.size() / wanted]);
  }
}

double yaw_between(const Se3& a, const Se3& b) {
  return std::abs(geometry::rpy_from_rotation(a.rotation().transpose() * b.rotation()).z());
}

}  // namespace

const char* name_of(Verdict verdict) {
  static constexpr std::array<const char*, kVerdicts> kNames = {
      "verified",  "few_points", "little_overlap", "few_inliers", "large_residual",
      "seen_through", "ambiguous", "degenerate", "yaw_disagrees", "far_from_guess"};
  return kNames[static_cast<std::size_t>(verdict)];
}

LoopVerifier::LoopVerifier(const VerificationConfig& config)
    : config_(config),
      map_(config.map),
      candidate_points_(config.points),
      search_points_(config.search_points),
      refine_points_(config.refine_points),
      modes_(config.modes),
      constraints_(2 * config.refine_points),
      features_(features_only(config.points)),
      association_(features_only(config.points)) {}

void LoopVerifier::set_submap(std::span<const Eigen::Vector3f> points_candidate, std::size_t own) {
  map_.clear();
  map_.insert(points_candidate, 0.0);
  submap_points_ = points_candidate.size();
  const auto own_points = points_candidate.first(std::min(own, points_candidate.size()));
  candidate_view_.clear();
  candidate_view_.add(own_points);
  take_evenly(own_points, candidate_points_);
}

double LoopVerifier::score_of(std::span<const Eigen::Vector3f> points_query, const Se3& T_candidate_query, std::size_t level,
                              double std_m) const {
  const Eigen::Matrix3f R = T_candidate_query.rotation().cast<float>();
  const Eigen::Vector3f t = T_candidate_query.translation().cast<float>();
  const auto half_information = static_cast<float>(0.5 / (std_m * std_m));
  constexpr auto kMost = static_cast<float>(kTruncation);
  float sum = 0.0F;
  for (const Eigen::Vector3f& p_query : points_query) {
    const Eigen::Vector3f p = R * p_query + t;
    const map::SurfaceCell* cell = map_.surface(p, level);
    if (cell != nullptr && cell->surface != map::Surface::kUnknown) {
      const float distance_m = cell->distance_m(p);
      sum += kMost - std::min(kMost, distance_m * distance_m * half_information);
    }
  }
  return points_query.empty() ? 0.0 : static_cast<double>(sum) / (kTruncation * static_cast<double>(points_query.size()));
}

/// The guess's own weight for a mode, its variance doubled: it is believed only half.
double LoopVerifier::weight_of(const Mode& mode, const LoopProposal& proposal) const {
  const Eigen::Vector3d off = mode.T_candidate_query.translation() - proposal.T_candidate_query.translation();
  const double std_m = std::max(proposal.position_std_m, config_.search_step_m / 3.0);
  return std::exp(-0.25 * off.head<2>().squaredNorm() / (std_m * std_m));
}

bool LoopVerifier::are_apart(const Se3& a, const Se3& b, double apart_m) const {
  return (a.translation() - b.translation()).norm() > apart_m || yaw_between(a, b) > config_.apart_rad;
}

/// Keeps the best modes that lie apart.
void LoopVerifier::offer(const Mode& mode) {
  for (Mode& other : modes_) {
    if (!are_apart(other.T_candidate_query, mode.T_candidate_query, config_.modes_apart_m)) {
      if (mode.score > other.score) {
        other = mode;
      }
      return;
    }
  }
  if (modes_.try_push_back(mode)) {
    return;
  }
  Mode& worst = *std::min_element(modes_.begin(), modes_.end(), [](const Mode& a, const Mode& b) { return a.score < b.score; });
  if (mode.score > worst.score) {
    worst = mode;
  }
}

void LoopVerifier::search(const LoopProposal& proposal) {
  const auto steps = [&](double std, double step, double most) {
    return static_cast<int>(std::floor(std::min(config_.search_sigmas * std, most) / step + 0.5));
  };
  const int along = steps(proposal.position_std_m, config_.search_step_m, config_.most_search_m);
  const int around = steps(proposal.yaw_std_rad, config_.search_step_rad, config_.most_search_rad);
  searched_ = along > 0;
  modes_.clear();
  for (int yaw = -around; yaw <= around; ++yaw) {
    // About the up of the candidate's base, which a ground vehicle's nearly is.
    const Eigen::Matrix3d turn = geometry::so3_exp({0.0, 0.0, yaw * config_.search_step_rad});
    for (int x = -along; x <= along; ++x) {
      for (int y = -along; y <= along; ++y) {
        const Eigen::Vector3d shift(x * config_.search_step_m, y * config_.search_step_m, 0.0);
        Mode mode{Se3(turn * proposal.T_candidate_query.rotation(), proposal.T_candidate_query.translation() + shift), 0.0};
        mode.score = score_of(search_points_.view(), mode.T_candidate_query, 1, config_.search_std_m);
        offer(mode);
      }
    }
  }
}

/// Moves a pose to where the points lie on planes through their nearest neighbours. Returns the constraints' sum there.
registration::NormalEquations LoopVerifier::register_to_planes(std::span<const Eigen::Vector3f> points_query, std::size_t wanted,
                                                               int associations, Se3& T_candidate_query) {
  features_.planar.clear();
  wanted = std::min({wanted, points_query.size(), features_.planar.capacity()});
  for (std::size_t k = 0; k < wanted; ++k) {
    const Eigen::Vector3f& p = points_query[k * points_query.size() / wanted];
    features_.planar.push_back({p, p.norm()});
  }
  Se3& T = T_candidate_query;
  association_.begin(features_);
  for (int i = 0; i < associations; ++i) {
    registration::associate(features_, map_, T, {}, association_);
    for (int k = 0; k < kStepsAnAssociation && i + 1 < associations; ++k) {
      registration::NormalEquations sum = registration::linearize(association_.constraints.view(), T, config_.kernel_m);
      sum.H.diagonal().array() += 1e-6 * sum.H.diagonal().maxCoeff() + 1e-9;
      T = geometry::boxplus(T, -sum.H.ldlt().solve(sum.g));
    }
  }
  T.rotation() = geometry::orthonormalized(T.rotation());
  return registration::linearize(association_.constraints.view(), T, config_.kernel_m);
}

/// How the two clouds contradict each other at a pose: the worse of the two ways to look.
LoopVerifier::Contradiction LoopVerifier::contradiction_of(std::span<const Eigen::Vector3f> points_query,
                                                           const Se3& T_candidate_query) const {
  const SeenThrough query = candidate_view_.seen_through(points_query, T_candidate_query);
  const SeenThrough candidate = query_view_.seen_through(candidate_points_.view(), T_candidate_query.inverse());
  return {std::max(query.share(), candidate.share()),
          std::max(query.share_of_at_least(config_.sight_points), candidate.share_of_at_least(config_.sight_points)),
          std::min(query.in_field, candidate.in_field)};
}

void LoopVerifier::refine_modes(std::span<const Eigen::Vector3f> points_query) {
  for (Mode& mode : modes_) {
    mode.T_candidate_query =
        registration::align_to_surfaces(refine_points_.view(), map_, mode.T_candidate_query, refining(), constraints_);
    const registration::NormalEquations sum =
        register_to_planes(refine_points_.view(), refine_points_.size(), kModeAssociations, mode.T_candidate_query);
    const double seen_through = contradiction_of(points_query, mode.T_candidate_query).for_modes;
    mode.score = static_cast<double>(sum.inliers) / static_cast<double>(refine_points_.size()) *
                 std::exp(-seen_through / config_.sight_scale);
  }
  std::sort(modes_.begin(), modes_.end(), [](const Mode& a, const Mode& b) { return a.score > b.score; });
}

void LoopVerifier::register_finely(std::span<const Eigen::Vector3f> points_query, Verification& result) {
  Se3& T = result.T_candidate_query;
  const registration::NormalEquations sum = register_to_planes(points_query, config_.points, kAssociations, T);
  result.overlap = static_cast<double>(sum.count) / static_cast<double>(features_.planar.size());
  if (sum.count == 0) {
    return;
  }
  result.inlier_ratio = static_cast<double>(sum.inliers) / static_cast<double>(sum.count);
  result.mean_residual_m = sum.absolute_sum_m / static_cast<double>(sum.count);
  const odometry::Localisability held =
      odometry::localisability_of(association_.constraints.view(), sum.H, T, config_.kernel_m, config_.degenerate_share);
  Matrix6d information = config_.information_share * sum.H;
  information.diagonal().array() += 1e-6;
  result.covariance = information.ldlt().solve(Matrix6d::Identity());
  result.covariance = (0.5 * (result.covariance + result.covariance.transpose())).eval();
  is_degenerate_ = held.weak.count != 0 || result.covariance.diagonal().head<3>().maxCoeff() > config_.most_std_m * config_.most_std_m ||
                   result.covariance.diagonal().tail<3>().maxCoeff() > config_.most_std_rad * config_.most_std_rad;
  const double common_m = std::max(config_.least_std_m, config_.common_share * result.mean_residual_m);
  const double common_rad = std::max(config_.least_std_rad, config_.common_rad_m * result.mean_residual_m);
  result.covariance.diagonal().head<3>().array() += common_m * common_m;
  result.covariance.diagonal().tail<3>().array() += common_rad * common_rad;
}

Verdict LoopVerifier::judge(const Verification& result, const LoopProposal& proposal, bool is_degenerate) const {
  const double searched = has_clear_sight_ ? config_.min_overlap_clear : config_.min_overlap_searched;
  if (!(result.overlap >= (result.searched ? searched : config_.min_overlap))) {
    return Verdict::kLittleOverlap;
  }
  if (!(result.inlier_ratio >= config_.min_inlier_ratio)) {
    return Verdict::kFewInliers;
  }
  if (!(result.mean_residual_m <= config_.max_mean_residual_m)) {
    return Verdict::kLargeResidual;
  }
  if (!(result.seen_through <= config_.max_seen_through)) {
    return Verdict::kSeenThrough;
  }
  if (!(result.runner_up <= config_.ambiguity_score && result.likelier <= 1.0)) {
    return Verdict::kAmbiguous;
  }
  if (is_degenerate) {
    return Verdict::kDegenerate;
  }
  if (!(yaw_between(result.T_candidate_query, proposal.T_candidate_query) <= 3.0 * proposal.yaw_std_rad + config_.yaw_slack_rad)) {
    return Verdict::kYawDisagrees;
  }
  const Eigen::Vector3d moved = result.T_candidate_query.translation() - proposal.T_candidate_query.translation();
  return moved.norm() <= 3.0 * proposal.position_std_m + config_.position_slack_m ? Verdict::kVerified : Verdict::kFarFromGuess;
}

Verification LoopVerifier::verify(std::span<const Eigen::Vector3f> points_query, const LoopProposal& proposal) {
  Verification result;
  result.T_candidate_query = proposal.T_candidate_query;
  if (points_query.size() < config_.min_points || submap_points_ < config_.min_points) {
    return result;
  }
  take_evenly(points_query, search_points_);
  take_evenly(points_query, refine_points_);
  query_view_.clear();
  query_view_.add(points_query);
  search(proposal);
  result.searched = searched_;
  refine_modes(points_query);
  const Mode& best = modes_[0];
  result.T_candidate_query = best.T_candidate_query;
  for (const Mode& mode : modes_) {
    if (are_apart(best.T_candidate_query, mode.T_candidate_query, config_.apart_m)) {
      const double ratio = mode.score / std::max(best.score, 1e-9);
      result.runner_up = std::max(result.runner_up, ratio);
      result.likelier = std::max(result.likelier, ratio * weight_of(mode, proposal) / weight_of(best, proposal));
    }
  }
  is_degenerate_ = false;
  register_finely(points_query, result);
  const Contradiction sight = contradiction_of(points_query, result.T_candidate_query);
  result.seen_through = sight.seen_through;
  has_clear_sight_ = sight.in_field >= config_.least_in_field && result.seen_through <= config_.clear_sight && result.inlier_ratio >= config_.min_inlier_ratio_clear &&
                     result.runner_up <= config_.clear_runner_up && result.likelier <= config_.clear_runner_up;
  result.verdict = judge(result, proposal, is_degenerate_);
  return result;
}

}  // namespace slamd::loop
