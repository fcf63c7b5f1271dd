#include "tools/report/accuracy.hpp"

#include <chrono>
#include <stdexcept>

namespace slamd::report {

using evaluation::Alignment;

evaluation::Trajectory trajectory_of(const FilterRun& run) {
  evaluation::Trajectory trajectory;
  for (const ScanSample& scan : run.scans) {
    trajectory.push_back(scan.pose);
  }
  return trajectory;
}

std::optional<Accuracy> accuracy_of(const FilterRun& run, const evaluation::Trajectory& truth) {
  Accuracy accuracy;
  accuracy.pairs =
      evaluation::associate_interpolated(truth, trajectory_of(run), std::chrono::seconds(1));
  const auto& pairs = accuracy.pairs;
  if (pairs.size() < 3) {
    return std::nullopt;
  }
  const auto ape = [&](const evaluation::Similarity& similarity) {
    return evaluation::statistics_of(evaluation::ape_translation_m(pairs, similarity));
  };
  try {
    accuracy.alignment = evaluation::align(pairs, Alignment::kSe3);
  } catch (const std::invalid_argument&) {
    accuracy.alignment = evaluation::align(pairs, Alignment::kYaw);
    accuracy.yaw_only = true;
  }
  accuracy.ape_m = ape(accuracy.alignment);
  accuracy.ape_yaw_m = ape(evaluation::align(pairs, Alignment::kYaw));
  accuracy.ape_origin_m = ape(evaluation::align(pairs, Alignment::kOrigin));
  accuracy.tilt_rad = evaluation::statistics_of(evaluation::tilt_rad(pairs));
  accuracy.end_drift_m = evaluation::end_drift_m(pairs, accuracy.alignment);
  evaluation::Trajectory covered;
  for (const evaluation::PosePair& pair : pairs) {
    covered.push_back({pair.stamp, pair.reference});
  }
  accuracy.true_path_m = evaluation::path_length_m(covered);
  return accuracy;
}

}  // namespace slamd::report
