#include "tools/evaluate/evaluate.hpp"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/base/units.hpp"
#include "drivers/recording/tum.hpp"
#include "tools/evaluate/motions.hpp"

namespace slamd::evaluate {

using evaluation::Alignment;
using evaluation::statistics_of;
using evaluation::PosePair;
using evaluation::Similarity;
using evaluation::Statistics;
using evaluation::Trajectory;
using nlohmann::ordered_json;

Trajectory read_trajectory(const std::string& file, const std::string& times) {
  Trajectory trajectory;
  const bool kitti = recording::is_kitti(file);
  if (kitti && times.empty()) {
    throw recording::RecordingError(file, "holds KITTI rows, which have no stamps: give them with --times FILE");
  }
  for (const recording::StampedPose& pose : kitti ? recording::read_kitti(file, times) : recording::read_tum(file)) {
    trajectory.push_back({pose.stamp, pose.T});
  }
  if (trajectory.empty()) {
    throw recording::RecordingError(file, "holds no poses");
  }
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    if (trajectory[i].stamp <= trajectory[i - 1].stamp) {
      throw recording::RecordingError(file, "pose " + std::to_string(i + 1) + " is not later than the one before it");
    }
  }
  return trajectory;
}

namespace {

std::vector<PosePair> associate(const Options& options, const Trajectory& reference, Trajectory estimate) {
  for (evaluation::TimedPose& pose : estimate) {
    pose.stamp += from_seconds(options.offset_s);
  }
  const std::vector<PosePair> pairs =
      options.evo ? evaluation::associate_nearest(reference, estimate, std::chrono::milliseconds(10))
                  : evaluation::associate_interpolated(reference, estimate, from_seconds(options.max_gap_s));
  if (pairs.size() < 2) {
    throw std::runtime_error(options.reference + " and " + options.estimate + " have no time in common");
  }
  return pairs;
}

ordered_json json_of(const Statistics& s, double unit = 1.0) {
  return {{"rmse", s.rmse / unit}, {"mean", s.mean / unit}, {"median", s.median / unit}, {"std", s.std / unit},
          {"min", s.min / unit},   {"max", s.max / unit},   {"count", s.count}};
}

std::string row(const char* name, const Statistics& s, double unit, const char* unit_name) {
  char line[160];
  std::snprintf(line, sizeof line, "%-28s %-4s %9.4f %9.4f %9.4f %9.4f %9.4f %8zu\n", name, unit_name, s.rmse / unit,
                s.mean / unit, s.median / unit, s.std / unit, s.max / unit, s.count);
  return line;
}

std::string table_of(const Measures& m, const Options& options) {
  char line[200];
  std::string text;
  std::snprintf(line, sizeof line, "%zu poses over %.1f m, %s\n\n", m.pairs, m.reference_path_m,
                options.evo ? "nearest stamps (evo's rules)" : "reference interpolated");
  text += line;
  std::snprintf(line, sizeof line, "%-33s %9s %9s %9s %9s %9s %8s\n", "", "rmse", "mean", "median", "std", "max", "count");
  text += line;
  if (m.collinear) {
    text += "APE, SE(3)-aligned           –    (the path is straight: no rotation can be found)\n";
  } else {
    text += row("APE, SE(3)-aligned", m.ape_se3_m, 1.0, "m");
    text += row("APE rotation, SE(3)-aligned", m.ape_rotation_rad, kDegree, "deg");
  }
  text += row("APE, yaw-aligned", m.ape_yaw_m, 1.0, "m");
  text += row("APE, unaligned", m.ape_unaligned_m, 1.0, "m");
  text += row("RPE translation", m.rpe_translation_m, 1.0, "m");
  text += row("RPE rotation", m.rpe_rotation_rad, kDegree, "deg");
  text += row("tilt, yaw-aligned", m.tilt_rad, kDegree, "deg");
  if (m.kitti.segments > 0) {
    std::snprintf(line, sizeof line, "\nKITTI segments: %.4f %% , %.5f deg/m (%zu segments of 100 to 800 m)\n",
                  100.0 * m.kitti.translation, m.kitti.rotation_radpm / kDegree, m.kitti.segments);
    text += line;
  }
  std::snprintf(line, sizeof line, "end drift: %.4f m, %.4f %% of the path (displacement from first to last pose, SE(3)-aligned)\n",
                m.end_drift_m, m.reference_path_m > 0.0 ? 100.0 * m.end_drift_m / m.reference_path_m : 0.0);
  text += line;
  return m.motions ? text + evaluate::table_of(*m.motions) : text;
}

}  // namespace

Measures measure(const std::vector<PosePair>& pairs, const Options& options) {
  Measures m;
  m.pairs = pairs.size();
  Trajectory reference;
  for (const PosePair& pair : pairs) {
    reference.push_back({pair.stamp, pair.reference});
  }
  m.reference_path_m = evaluation::path_length_m(reference);
  Similarity se3 = evaluation::align(pairs, Alignment::kYaw, options.align_count);
  m.ape_yaw_m = statistics_of(ape_translation_m(pairs, se3));
  try {
    se3 = evaluation::align(pairs, Alignment::kSe3, options.align_count);
  } catch (const std::invalid_argument&) {
    m.collinear = true;
  }
  m.ape_se3_m = statistics_of(ape_translation_m(pairs, se3));
  m.ape_rotation_rad = statistics_of(ape_rotation_rad(pairs, se3));
  m.ape_unaligned_m = statistics_of(ape_translation_m(pairs, Similarity{}));
  const evaluation::RelativeErrors relative = evaluation::rpe(pairs, evaluation::select_pairs(pairs, options.rule));
  m.rpe_translation_m = statistics_of(relative.translation_m);
  m.rpe_rotation_rad = statistics_of(relative.rotation_rad);
  m.kitti = evaluation::kitti_segments(pairs);
  m.tilt_rad = statistics_of(evaluation::tilt_rad(pairs));
  m.end_drift_m = evaluation::end_drift_m(pairs, se3);
  return m;
}

std::string json_of(const Measures& m) {
  ordered_json json;
  json["pairs"] = m.pairs;
  json["reference_path_m"] = m.reference_path_m;
  json["ape_m"] = {{"se3", m.collinear ? ordered_json() : json_of(m.ape_se3_m)}, {"yaw", json_of(m.ape_yaw_m)}, {"none", json_of(m.ape_unaligned_m)}};
  json["ape_rotation_deg"] = json_of(m.ape_rotation_rad, kDegree);
  json["rpe_m"] = json_of(m.rpe_translation_m);
  json["rpe_deg"] = json_of(m.rpe_rotation_rad, kDegree);
  json["kitti"] = {{"segments", m.kitti.segments}, {"translation_percent", 100.0 * m.kitti.translation}, {"rotation_deg_per_m", m.kitti.rotation_radpm / kDegree}};
  json["tilt_deg"] = json_of(m.tilt_rad, kDegree);
  json["end_drift_m"] = m.end_drift_m;
  json["end_drift_percent"] = m.reference_path_m > 0.0 ? 100.0 * m.end_drift_m / m.reference_path_m : 0.0;
  if (m.motions) {
    json["motions"] = ordered_json::parse(json_of(*m.motions));
  }
  return json.dump(2) + "\n";
}

std::string evaluate(const Options& options) {
  Options resolved = options;
  resolved.rule.unit = options.unit == "frames" ? evaluation::DeltaUnit::kFrames
                       : options.unit == "deg"  ? evaluation::DeltaUnit::kRadians
                                                : evaluation::DeltaUnit::kMetres;
  if (options.unit == "deg") {
    resolved.rule.delta *= kDegree;
  }
  const std::vector<PosePair> pairs =
      associate(resolved, read_trajectory(options.reference, options.times), read_trajectory(options.estimate, options.times));
  Measures measures = measure(pairs, resolved);
  if (!resolved.motions.empty()) {
    std::vector<evaluation::MotionClaim> claims = read_motions(resolved.motions);
    for (evaluation::MotionClaim& claim : claims) {
      claim.first += from_seconds(resolved.offset_s);
      claim.last += from_seconds(resolved.offset_s);
    }
    measures.motions = evaluation::consistency_of(evaluation::motion_errors(pairs, claims));
    if (measures.motions->pose.count == 0) {
      throw std::runtime_error(resolved.motions + " and " + resolved.estimate + " have no stamps in common");
    }
  }
  return options.json ? json_of(measures) : table_of(measures, options);
}

}  // namespace slamd::evaluate
