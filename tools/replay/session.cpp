#include "tools/replay/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/base/units.hpp"
#include "daemon/configuration/key_table.hpp"
#include "drivers/recording/tum.hpp"
#include "tools/evaluate/loops.hpp"
#include "tools/evaluate/motions.hpp"
#include "tools/report/accuracy.hpp"
#include "tools/report/report.hpp"

namespace slamd::replay {

using nlohmann::ordered_json;
using odometry::Filter;

namespace {

constexpr std::uint64_t kReplayedSession = 0;  // the same bytes from the same recording

report::FilterRun filter_run(const std::string& filter, const Run& run) {
  report::FilterRun result{filter, {"decode", "preprocess", "odometry"}, {}};
  for (const ScanRecord& record : run.scans) {
    const odometry::OdometryResult& odometry = record.odometry;
    report::ScanSample sample;
    sample.pose = {odometry.stamp, odometry.T_odom_base};
    sample.stage_ms = {record.decode_ms, record.times.preprocess_ms, record.times.odometry_ms};
    sample.particles = odometry.swarm.particles;
    sample.recovery_swarm = odometry.swarm.recovery;
    sample.swarm_won = odometry.swarm.swarm_won;
    sample.state = name_of(odometry.state);
    sample.cause = odometry.cause == odometry::Cause::kNone ? "" : in_words(odometry.cause, odometry.weak_axes_base);
    result.scans.push_back(std::move(sample));
  }
  return result;
}

ordered_json accuracy_json(const report::Accuracy& accuracy) {
  return {{"ape_rmse_m", accuracy.ape_m.rmse},
          {"ape_max_m", accuracy.ape_m.max},
          {"alignment", accuracy.yaw_only ? "yaw" : "se3"},
          {"ape_yaw_rmse_m", accuracy.ape_yaw_m.rmse},
          {"tilt_mean_deg", accuracy.tilt_rad.mean / kDegree},
          {"end_drift_m", accuracy.end_drift_m},
          {"end_drift_percent", accuracy.true_path_m > 0.0 ? 100.0 * accuracy.end_drift_m / accuracy.true_path_m : 0.0}};
}

std::string number(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

TimeSummary cpu_of(const Run& run) {
  std::vector<double> ms;
  for (const ScanRecord& record : run.scans) {
    ms.push_back(record.decode_ms + record.times.preprocess_ms + record.times.odometry_ms);
  }
  return summary_of(std::move(ms));
}

}  // namespace

Session::Session(Recording recording, std::filesystem::path directory)
    : recording_(std::move(recording)), directory_(std::move(directory)) {
  if (!recording_.truth.empty()) {
    for (const recording::StampedPose& pose : recording::read_tum(recording_.truth)) {
      truth_.push_back({pose.stamp, pose.T});
    }
  }
}

std::string Session::filter_name() const {
  return recording_.configuration.odometry.filter == Filter::kPsf ? "psf" : "iekf";
}

void Session::run_with(const std::function<Run(const Sinks&)>& replay, const std::function<void(double)>& progress) {
  ProductWriter writer(directory_, recording_.configuration.output.map_spacing_m);
  std::optional<MappingRun> mapping;
  if (recording_.configuration.mapping.use) {
    const storage::SessionBegin begin{kReplayedSession, 0, configuration::name_of(recording_.configuration.lidar.model), "slamd " SLAMD_VERSION};
    mapping.emplace(stages::mapper_config(recording_.configuration), directory_, begin);
  }
  run_ = replay({[&](const ScanRecord& record, const scan::DeskewedScan& scan, const odometry::MotionStep& motion) {
                   writer.add(record, scan, motion);
                   if (mapping) {
                     mapping->add(record, scan, motion);
                   }
                 },
                 progress, [&](const odometry::OdometryResult& step) { writer.add_silent(step); }});
  mapping_ = mapping ? std::optional(mapping->finish()) : std::nullopt;
  const mapping::CorrectedPath path(is_corrected() ? mapping_->path : std::vector<mapping::CorrectedKeyframe>());
  writer.close(is_corrected() ? &path : nullptr);
  trajectory_ = writer.trajectory();
  motions_ = writer.motions();
  map_points_ = writer.picture_points();
}

/// The run with its corrected poses: nothing where the map is odom.
std::optional<report::FilterRun> Session::map_run() const {
  if (!is_corrected()) {
    return std::nullopt;
  }
  report::FilterRun run{"map", {}, {}};
  for (const evaluation::TimedPose& pose : trajectory_) {
    run.scans.emplace_back();
    run.scans.back().pose = pose;
  }
  return run;
}

/// How well the loops are, where the truth is known: near is 2 m where most of the drive was indoors.
std::optional<evaluation::LoopQuality> Session::loop_quality() const {
  if (!mapping_ || truth_.empty()) {
    return std::nullopt;
  }
  const auto indoor = std::count_if(run_.scans.begin(), run_.scans.end(), [](const ScanRecord& record) { return record.odometry.indoor; });
  evaluation::RevisitRule rule;
  rule.near_m = 2 * static_cast<std::size_t>(indoor) > run_.scans.size() ? 2.0 : rule.near_m;
  rule.view_rad = recording_.configuration.mapping.view_deg * kDegree;
  return evaluation::loop_quality_of(truth_, mapping_->claimed, rule);
}

void Session::run(const std::function<void(double)>& progress) {
  run_with([&](const Sinks& sinks) { return replay(recording_, sinks); }, progress);
}

void Session::run(PacketSource& source, const evaluation::Trajectory& truth, const std::function<void(double)>& progress) {
  truth_ = truth;
  run_with([&](const Sinks& sinks) { return replay(recording_.configuration, source, sinks); }, progress);
}

void Session::compare(const std::string& filter, const std::function<void(double)>& progress) {
  Recording other = recording_;
  other.configuration.odometry.filter = filter == "psf" ? Filter::kPsf : Filter::kIekf;
  compared_filter_ = filter;
  compared_ = replay(other, {nullptr, progress});
  const std::filesystem::path file = directory_ / ("odometry-" + filter + ".tum");
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "wb"), std::fclose);
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be written");
  }
  for (const evaluation::TimedPose& pose : trajectory_of(*compared_)) {
    recording::write_tum_line(stream.get(), pose.stamp, pose.T);
  }
}

std::string Session::json() const {
  ordered_json accuracy;
  const auto add = [&](const std::string& filter, const Run& run) {
    if (const auto found = report::accuracy_of(filter_run(filter, run), truth_)) {
      accuracy[filter] = accuracy_json(*found);
      if (const auto errors = evaluation::motion_errors(found->pairs, motions_); &run == &run_ && !errors.empty()) {
        accuracy[filter]["motions_10m"] = ordered_json::parse(evaluate::json_of(evaluation::consistency_of(errors)));
      }
    }
  };
  add(filter_name(), run_);
  if (compared_) {
    add(compared_filter_, *compared_);
  }
  if (const auto corrected = map_run()) {
    if (const auto found = report::accuracy_of(*corrected, truth_)) {
      accuracy["map"] = accuracy_json(*found);
    }
  }
  if (const auto loops = loop_quality()) {
    accuracy["loops"] = ordered_json::parse(evaluate::json_of(*loops));
  }
  return report_json(recording_, run_, mapping_ ? &*mapping_ : nullptr, accuracy.is_null() ? std::string() : accuracy.dump());
}

void Session::write_reports() const {
  const std::filesystem::path json_file = directory_ / "report.json";
  std::ofstream stream(json_file);
  stream << json();
  if (!stream.flush()) {
    throw std::runtime_error(json_file.string() + ": cannot be written");
  }
  report::ReportContent content;
  content.recording = recording_.name.string();
  content.made_with = "slamd-replay " SLAMD_VERSION;
  content.run = filter_run(filter_name(), run_);
  if (compared_) {
    content.comparison = filter_run(compared_filter_, *compared_);
  }
  content.map_run = map_run();
  content.loops = mapping_ ? mapping_->edges : content.loops;
  content.truth = truth_;
  content.map_points = map_points_;
  content.facts = {{"scans before the start", std::to_string(run_.scans_before_start)},
                   {"times real time", number("%.1f", run_.wall_s > 0.0 ? run_.recording_s / run_.wall_s : 0.0)},
                   {"LiDAR", configuration::name_of(recording_.configuration.lidar.model)}};
  content.counters = {{"Packets", run_.packets}, {"Blocks of points", run_.blocks}, {"Inertial samples", run_.imu}};
  if (mapping_) {
    const mapping::LoopCounts& loops = mapping_->loops;
    content.counters.push_back({"Loops", {{"keyframes", mapping_->keyframes},
                                          {"candidates", loops.candidates},
                                          {"verified", loops.verified()},
                                          {"accepted", loops.accepted()},
                                          {"removed", loops.removed()}}});
  }
  content.remarks = run_.remarks;
  content.configuration = configuration::print_configuration(recording_.configuration);
  report::write_report(directory_ / "report.html", content);
}

std::string Session::summary() const {
  const TimeSummary cpu = cpu_of(run_);
  std::string text = recording_.name.string() + ": " + std::to_string(run_.scans.size()) + " scans, " +
                     number("%.1f m", path_m(run_)) + ", " +
                     (run_.scans.empty() ? "STARTING: no scan came after the start-up" : name_of(run_.scans.back().odometry.state)) +
                     number(", %.1f ms a scan (median)", cpu.median) + number(", p99 %.1f ms", cpu.p99) + "\n";
  const auto add = [&](const std::string& filter, const Run& run) {
    if (const auto found = report::accuracy_of(filter_run(filter, run), truth_)) {
      text += "  " + filter + number(": APE %.4f m", found->ape_m.rmse) + number(", end drift %.4f m", found->end_drift_m) +
              number(" (%.4f %% of the path)", found->true_path_m > 0.0 ? 100.0 * found->end_drift_m / found->true_path_m : 0.0) + "\n";
    }
  };
  add(filter_name(), run_);
  if (compared_) {
    add(compared_filter_, *compared_);
  }
  if (const auto corrected = map_run()) {
    text += "  map: " + std::to_string(mapping_->edges.size()) + " loops";
    if (const auto found = report::accuracy_of(*corrected, truth_)) {
      text += number(", APE %.4f m", found->ape_m.rmse) + number(", end drift %.4f m", found->end_drift_m);
    }
    text += "\n";
  }
  if (const auto loops = loop_quality(); loops && loops->revisits > 0) {
    text += "  loops: " + number("%.1f %% of the revisits closed", 100.0 * loops->recall()) + ", " + std::to_string(loops->wrong) + " wrong\n";
  }
  for (const std::string& remark : run_.remarks) {
    text += "  " + remark + "\n";
  }
  return text + "  " + (directory_ / "report.html").string() + "\n";
}

}  // namespace slamd::replay
