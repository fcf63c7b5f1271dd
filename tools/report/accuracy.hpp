#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/errors.hpp"
#include "tools/report/content.hpp"

namespace slamd::report {

/// A run held against the truth.
struct Accuracy {
  std::vector<evaluation::PosePair> pairs;
  evaluation::Similarity alignment;  // SE(3), or yaw where the path is a straight line
  bool yaw_only = false;
  evaluation::Statistics ape_m;  // aligned by `alignment`
  evaluation::Statistics ape_yaw_m;
  evaluation::Statistics ape_origin_m;  // first pose on first pose
  evaluation::Statistics tilt_rad;
  double end_drift_m = 0.0;
  double true_path_m = 0.0;
};

/// Returns nothing where truth and run have fewer than three poses in common.
std::optional<Accuracy> accuracy_of(const FilterRun& run, const evaluation::Trajectory& truth);

/// Returns a run's poses.
evaluation::Trajectory trajectory_of(const FilterRun& run);

}  // namespace slamd::report
