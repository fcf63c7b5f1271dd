#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/loop/proposal.hpp"
#include "core/loop/view.hpp"
#include "core/map/voxel_map.hpp"
#include "core/registration/association.hpp"
#include "core/registration/constraint.hpp"
#include "core/scan/preprocessor.hpp"

namespace slamd::loop {

/// What became of a proposal at its gates, in their order.
enum class Verdict : std::uint8_t {
  kVerified,
  kFewPoints,      // of one of the clouds
  kLittleOverlap,  // too few points of the query meet a surface of the submap
  kFewInliers,     // of those that meet one, too few lie on it
  kLargeResidual,  // they lie off it on the average
  kSeenThrough,    // one cloud has looked through surfaces of the other
  kAmbiguous,      // another pose within the search fits about as well
  kDegenerate,     // the surfaces do not hold every direction
  kYawDisagrees,   // with the proposal's
  kFarFromGuess,   // farther than the guess can be wrong
};
inline constexpr std::size_t kVerdicts = 10;

const char* name_of(Verdict verdict);

struct VerificationConfig {
  // the submap
  map::VoxelMapConfig map{.cell_m = 1.0F, .surface_cell_m = 0.6F, .window_m = 1e9F, .max_cells = 16'000, .max_surface_cells = 36'000};
  // the search: poses on a grid around the guess, the best of them refined
  std::size_t search_points = 160;
  std::size_t refine_points = 300;
  double search_step_m = 0.9;
  double search_step_rad = 0.07;     // 4°
  double search_sigmas = 3.0;        // of the guess's uncertainty
  double most_search_m = 8.0;        // to each side
  double most_search_rad = 0.30;
  double search_std_m = 0.5;         // of a point against the larger cells
  std::size_t modes = 5;
  double sight_scale = 0.01;         // seen through: a mode's score falls by e for each such share
  std::size_t sight_points = 400;    // in a smaller field a point weighs as one of so many: a stray one does not decide
  double modes_apart_m = 1.7;        // before they are refined
  // the final registration
  std::size_t points = 1'024;
  std::size_t min_points = 200;
  double kernel_m = 0.10;            // Cauchy; constraints within it are inliers
  double information_share = 0.2;    // points of a cloud share their errors
  // What all points of a cloud have in common: with the mean residual it grew so on simulated drives. Turns are believed three
  // times less than they were found to err: a milliradian at a loop is a decimetre at the other end of the map, and
  // the positions of several loops tell the turns better.
  double common_share = 0.35;        // of the mean residual: standard deviation along each axis
  double common_rad_m = 0.24;        // times the mean residual: about each axis
  double least_std_m = 0.01;         // no registration is believed to be better
  double least_std_rad = 0.004;
  // the gates
  double min_overlap = 0.45;
  double min_overlap_searched = 0.7;  // where the guess leaves room for more than one pose
  double min_inlier_ratio = 0.6;
  double max_mean_residual_m = 0.12;
  double max_seen_through = 0.03;    // of the points of either cloud in the other's field
  // Clear sight: next to nothing is seen through and no other pose comes near. Then less overlap is enough after a search: what
  // does not overlap stood behind something.
  double min_overlap_clear = 0.5;
  double min_inlier_ratio_clear = 0.75;
  double clear_sight = 0.002;        // seen through at most
  double clear_runner_up = 0.6;
  std::size_t least_in_field = 100;  // points that could have contradicted
  double ambiguity_score = 0.75;     // of the best mode's, at another pose
  double apart_m = 0.8;
  double apart_rad = 0.09;
  double degenerate_share = 0.014;   // of the information along a direction: as in odometry::UpdateConfig
  double most_std_m = 0.2;           // along or about any axis
  double most_std_rad = 0.02;
  double yaw_slack_rad = 0.05;       // beside three standard deviations
  double position_slack_m = 1.0;     // likewise
};

/// What registration found.
/// Frames: T_candidate_query of base at both keyframes; covariance of (δp, δθ): position in the candidate's axes, rotation
/// in the query's, as graph::Motion has it.
struct Verification {
  Verdict verdict = Verdict::kFewPoints;
  geometry::Se3 T_candidate_query;
  geometry::Matrix6d covariance = geometry::Matrix6d::Identity();
  double overlap = 0.0;           // share of the query's points that meet a surface
  double inlier_ratio = 0.0;      // of these
  double mean_residual_m = 0.0;
  double seen_through = 0.0;      // greater share of one cloud's points that the other has looked through
  bool searched = false;          // the guess was uncertain
  double likelier = 0.0;          // score of the likeliest other mode, by the best one's, both weighed by the guess
  double runner_up = 0.0;         // score of the second-best mode, by the best one's
};

/// Registers a keyframe's cloud against the submap around a candidate and judges the result.
///
/// Where the guess is uncertain, poses on a grid over x, y and yaw are scored on the submap's larger cells (truncated squared
/// residuals), the best few that lie apart are registered coarse to fine, at last to planes through nearest neighbours, and
/// the one with most points on a plane is registered with more points. Each gate must be passed; a second mode that fits about as well makes the place ambiguous, as racks
/// of shelves are; and so does one that fits less well, but lies where the guess has it.
/// Real-time: memory sized once; some 10 to 30 ms; mapping thread only.
class LoopVerifier {
 public:
  explicit LoopVerifier(const VerificationConfig& config);

  /// Takes in the submap: the candidate's cloud (the first `own` points) and its neighbours', in base of the candidate. It
  /// serves all queries until the next call.
  void set_submap(std::span<const Eigen::Vector3f> points_candidate, std::size_t own);

  /// Judges a proposal for the submap. points_query are in base of the query.
  Verification verify(std::span<const Eigen::Vector3f> points_query, const LoopProposal& proposal);

 private:
  struct Mode {
    geometry::Se3 T_candidate_query;
    double score = 0.0;  // 0..1: at last the share of points on a plane, less where the clouds contradict each other
  };
  struct Contradiction {
    double seen_through = 0.0;  // the greater share of the two ways to look
    double for_modes = 0.0;     // likewise, less in a small field
    std::size_t in_field = 0;   // the fewer points
  };

  double score_of(std::span<const Eigen::Vector3f> points_query, const geometry::Se3& T_candidate_query, std::size_t level,
                  double std_m) const;
  void search(const LoopProposal& proposal);
  void offer(const Mode& mode);
  double weight_of(const Mode& mode, const LoopProposal& proposal) const;
  bool are_apart(const geometry::Se3& a, const geometry::Se3& b, double apart_m) const;
  void refine_modes(std::span<const Eigen::Vector3f> points_query);
  registration::NormalEquations register_to_planes(std::span<const Eigen::Vector3f> points_query, std::size_t wanted,
                                                   int associations, geometry::Se3& T_candidate_query);
  void register_finely(std::span<const Eigen::Vector3f> points_query, Verification& result);
  Contradiction contradiction_of(std::span<const Eigen::Vector3f> points_query, const geometry::Se3& T_candidate_query) const;
  Verdict judge(const Verification& result, const LoopProposal& proposal, bool is_degenerate) const;

  VerificationConfig config_;
  map::VoxelMap map_;
  std::size_t submap_points_ = 0;
  View candidate_view_;
  // scratch, sized once
  BoundedVector<Eigen::Vector3f> candidate_points_;  // its own, some of them
  View query_view_;
  BoundedVector<Eigen::Vector3f> search_points_;
  BoundedVector<Eigen::Vector3f> refine_points_;
  BoundedVector<Mode> modes_;
  BoundedVector<registration::Constraint> constraints_;
  scan::DeskewedScan features_;
  registration::Association association_;
  bool searched_ = false;
  bool is_degenerate_ = false;
  bool has_clear_sight_ = false;
};

}  // namespace slamd::loop
