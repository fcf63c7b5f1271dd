#pragma once

#include <span>
#include <vector>

#include "core/evaluation/alignment.hpp"
#include "core/evaluation/trajectory.hpp"

namespace slamd::evaluation {

/// Statistics of a list of errors, in its unit. std is that of the population, as evo's.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double std = 0.0;
  double min = 0.0;
  double max = 0.0;
  double sse = 0.0;
};

Statistics statistics_of(std::vector<double> errors);

/// Returns ‖p_estimate − p_reference‖ of each pair after alignment. Units: m.
std::vector<double> ape_translation_m(std::span<const PosePair> pairs, const Similarity& similarity);

/// Returns the angle of R_referenceᵀ R_estimate of each pair after alignment. Units: rad.
std::vector<double> ape_rotation_rad(std::span<const PosePair> pairs, const Similarity& similarity);

/// Returns ‖T_reference⁻¹ T_estimate − I‖ (Frobenius) of each pair after alignment: metres and radians in one, as evo's
/// relation "full".
std::vector<double> ape_full(std::span<const PosePair> pairs, const Similarity& similarity);

/// The unit in which RPE's pairs are apart.
enum class DeltaUnit { kFrames, kMetres, kRadians };

/// How RPE's pairs are chosen. Source: evo core/filters.py, re-implemented from its description.
struct PairRule {
  double delta = 1.0;
  DeltaUnit unit = DeltaUnit::kFrames;
  bool all_pairs = false;
  bool from_reference = false;       // evo takes them from the estimate unless told otherwise
  double relative_tolerance = 0.1;   // of all pairs by metres or angle
};

struct IndexPair {
  std::size_t first = 0;
  std::size_t second = 0;
};

/// Returns the pairs of indices that a rule selects.
std::vector<IndexPair> select_pairs(std::span<const PosePair> pairs, const PairRule& rule);

/// Relative pose errors: E = (Q_i⁻¹Q_j)⁻¹ (P_i⁻¹P_j), Q reference, P estimate.  Units: m, rad.
struct RelativeErrors {
  std::vector<double> translation_m;
  std::vector<double> rotation_rad;
};

RelativeErrors rpe(std::span<const PosePair> pairs, std::span<const IndexPair> indices);

/// Returns | ‖q_i − q_j‖ − ‖p_i − p_j‖ | of each pair: by how much a distance is wrong, whatever the attitude.
/// Units: m.
std::vector<double> rpe_distance_m(std::span<const PosePair> pairs, std::span<const IndexPair> indices);

/// Mean relative errors over the segments of 100..800 m. Units: translation as a share, rotation in rad/m.
/// Source: KITTI odometry devkit: starts every 10 poses, segment ends at the first pose that is farther along the
/// reference than its length (strictly), divided by the nominal length; plain mean over all segments.
struct KittiErrors {
  std::size_t segments = 0;
  double translation = 0.0;
  double rotation_radpm = 0.0;
};

KittiErrors kitti_segments(std::span<const PosePair> pairs);

/// Returns the angle between the estimated and the true vertical of each pair, after alignment by yaw. Units: rad.
std::vector<double> tilt_rad(std::span<const PosePair> pairs);

/// Returns by how much the displacement from the first to the last position is wrong, after alignment. On a closed tour
/// this is the error of closing it; the attitude of the first pose has no part in it. Units: m.
double end_drift_m(std::span<const PosePair> pairs, const Similarity& similarity);

}  // namespace slamd::evaluation
