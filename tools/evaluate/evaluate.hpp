#pragma once

#include <optional>
#include <string>

#include "core/evaluation/errors.hpp"
#include "core/evaluation/nees.hpp"

namespace slamd::evaluate {

struct Options {
  std::string reference;
  std::string estimate;
  std::string times;  // of KITTI rows; empty: TUM
  std::string motions;  // motions.csv beside the estimate; empty: none
  std::string unit = "m";
  evaluation::PairRule rule{.delta = 10.0, .unit = evaluation::DeltaUnit::kMetres};
  double max_gap_s = 1.0;
  double offset_s = 0.0;  // added to the estimate's stamps
  std::size_t align_count = 0;
  bool json = false;
  bool evo = false;
};

/// Reads a trajectory: TUM, or KITTI rows with the file of their stamps.
/// Errors: RecordingError for one that cannot be read, is empty, or whose stamps do not grow.
evaluation::Trajectory read_trajectory(const std::string& file, const std::string& times = {});

/// All measures of one comparison. Units: m, rad; shares as such.
struct Measures {
  std::size_t pairs = 0;
  double reference_path_m = 0.0;
  evaluation::Statistics ape_se3_m;
  evaluation::Statistics ape_yaw_m;
  evaluation::Statistics ape_unaligned_m;
  evaluation::Statistics ape_rotation_rad;  // SE(3)-aligned
  evaluation::Statistics rpe_translation_m;
  evaluation::Statistics rpe_rotation_rad;
  evaluation::KittiErrors kitti;
  evaluation::Statistics tilt_rad;
  double end_drift_m = 0.0;
  std::optional<evaluation::MotionConsistency> motions;
  bool collinear = false;  // SE(3) could not be found: a straight path
};

/// Measures pairs as the options say.
Measures measure(const std::vector<evaluation::PosePair>& pairs, const Options& options);

/// Prints measures as JSON.
std::string json_of(const Measures& measures);

/// Reads, compares and returns what is to be printed; writes the plot when asked.
/// Errors: RecordingError, std::runtime_error with one line.
std::string evaluate(const Options& options);

}  // namespace slamd::evaluate
