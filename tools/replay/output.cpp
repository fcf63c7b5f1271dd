#include "tools/replay/output.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>

#include <nlohmann/json.hpp>

#include "core/mapping/corrections.hpp"
#include "drivers/recording/tum.hpp"
#include "drivers/storage/ply_reader.hpp"
#include "tools/replay/covariance_columns.hpp"
#include "tools/replay/mapping_run.hpp"

namespace slamd::replay {

using nlohmann::ordered_json;

namespace {

std::unique_ptr<std::FILE, int (*)(std::FILE*)> open(const std::filesystem::path& file) {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "wb"), std::fclose);
  if (!stream) {
    throw recording::RecordingError(file, std::strerror(errno));
  }
  return stream;
}

/// The largest resident set of this process so far. Units: MB.
double peak_rss_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) {
      return std::stod(line.substr(6)) / 1024.0;
    }
  }
  return 0.0;
}

ordered_json json_of(const stages::NamedCounts& counts) {
  ordered_json object = ordered_json::object();
  for (const auto& [name, count] : counts) {
    object[name] = count;
  }
  return object;
}

ordered_json json_of(const GnssSummary& gnss) {
  ordered_json object;
  object["fixes"] = gnss.state.good;
  object["refused"] = json_of(gnss.refused);
  object["span_s"] = std::round(1e3 * to_seconds(gnss.state.span())) / 1e3;
  if (const auto& origin = gnss.state.origin) {
    object["origin"] = {{"lat_deg", origin->latitude_deg}, {"lon_deg", origin->longitude_deg}, {"alt_m", origin->altitude_m}};
  }
  return object;
}

double degrees(double rad) { return std::round(1e3 * rad * 180.0 / M_PI) / 1e3; }

/// Null where the drive has not shown it.
ordered_json json_of(const calibration::LidarImuAgreement& agreement) {
  ordered_json object;
  object["windows"] = agreement.windows;
  const auto ms = [](double s) { return std::round(1e6 * s) / 1e3; };
  object["offset_ms"] = agreement.known ? ordered_json(ms(agreement.offset_s.value)) : ordered_json();
  object["offset_std_ms"] = agreement.windows > 0 ? ordered_json(ms(agreement.offset_s.std)) : ordered_json();
  for (const calibration::Estimate& about : agreement.rotation_rad) {
    object["rotation_deg"].push_back(agreement.known ? ordered_json(degrees(about.value)) : ordered_json());
    object["rotation_std_deg"].push_back(agreement.windows > 0 ? ordered_json(degrees(about.std)) : ordered_json());
  }
  return object;
}

ordered_json json_of(const calibration::GravityAgreement& agreement) {
  ordered_json object;
  object["way_m"] = std::round(10.0 * agreement.way_m) / 10.0;
  const auto angle = [&](double rad) { return agreement.known ? ordered_json(degrees(rad)) : ordered_json(); };
  object["roll_deg"] = angle(agreement.roll_rad.value);
  object["roll_std_deg"] = angle(agreement.roll_rad.std);
  object["pitch_deg"] = angle(agreement.pitch_rad.value);
  object["pitch_std_deg"] = angle(agreement.pitch_rad.std);
  return object;
}

ordered_json json_of(const TimeSummary& times) {
  const auto rounded = [](double ms) { return std::round(1e3 * ms) / 1e3; };
  return {{"median", rounded(times.median)}, {"p95", rounded(times.p95)}, {"p99", rounded(times.p99)}, {"max", rounded(times.max)}};
}

ordered_json json_of(const mapping::LoopCounts& counts) {
  ordered_json verdicts = ordered_json::object();
  for (std::size_t i = 1; i < loop::kVerdicts; ++i) {
    verdicts[loop::name_of(static_cast<loop::Verdict>(i))] = counts.verdicts[i];
  }
  const auto proposed = [&](graph::Proposal proposal) { return counts.proposed[static_cast<std::size_t>(proposal)]; };
  const auto said = [&](graph::LoopVerdict verdict) { return counts.graph_verdicts[static_cast<std::size_t>(verdict)]; };
  return {{"candidates", counts.candidates},
          {"verified", counts.verified()},
          {"accepted", counts.accepted()},
          {"removed", counts.removed()},
          {"refused", verdicts},
          {"contradicts_odometry", proposed(graph::Proposal::kContradictsOdometry)},
          {"no_support", said(graph::LoopVerdict::kGivenUp)}};
}

template <typename Get>
TimeSummary stage(const Run& run, Get&& get) {
  std::vector<double> values;
  for (const ScanRecord& record : run.scans) {
    values.push_back(get(record));
  }
  return summary_of(std::move(values));
}

/// The scans and the time in each state, and the causes of it. A state holds from the scan, or the step without one, before
/// it on; the causes count both.
ordered_json states_of(const Run& run) {
  std::map<std::string, std::map<std::string, std::uint64_t>> causes;
  std::map<std::string, std::uint64_t> scans;
  std::map<std::string, Duration> times;
  std::optional<Stamp> before;
  const auto pass = [&](Stamp stamp, const std::string& state) {
    times[state] += before ? stamp - *before : Duration{};
    before = stamp;
  };
  auto silent = run.silent.begin();
  const auto pass_silence = [&](Stamp until) {
    for (; silent != run.silent.end() && silent->stamp < until; ++silent) {
      pass(silent->stamp, name_of(silent->state));
      scans.try_emplace(name_of(silent->state), 0);
      ++causes[name_of(silent->state)][name_of(silent->cause)];
    }
  };
  for (const ScanRecord& record : run.scans) {
    pass_silence(record.odometry.stamp);
    const std::string state = name_of(record.odometry.state);
    ++scans[state];
    pass(record.odometry.stamp, state);
    if (record.odometry.cause != odometry::Cause::kNone) {
      ++causes[state][in_words(record.odometry.cause, record.odometry.weak_axes_base)];
    }
  }
  pass_silence(Stamp::max());
  ordered_json states = ordered_json::object();
  for (const auto& [state, count] : scans) {
    const double time_s = std::round(1e3 * to_seconds(times[state])) / 1e3;
    states[state] = {{"scans", count}, {"time_s", time_s}, {"causes", causes[state]}};
  }
  return states;
}

void write_scan_header(std::FILE* file) {
  std::fputs("timestamp_ns,state,cause,weak_axes,weak_x,weak_y,weak_z,share,raw_share,matched,inliers,up_x,up_y,up_std_rad", file);
  write_covariance_names(file);
  std::fputc('\n', file);
}

/// A scan's state and covariance; the same order as pose_covariance of pose_t.
void write_scan_row(std::FILE* file, const odometry::OdometryResult& result) {
  const odometry::Localisability& weak = result.localisability;
  std::fprintf(file, "%lld,%s,%d,%d,%.4f,%.4f,%.4f,%.6f,%.6f,%.4f,%.4f,%.6f,%.6f,%.6f", static_cast<long long>(result.stamp.time_since_epoch().count()),
               name_of(result.state), static_cast<int>(result.cause), result.weak_axes, weak.weakest_odom.x(),
               weak.weakest_odom.y(), weak.weakest_odom.z(), weak.share, weak.raw_share, result.update.matched_ratio, result.update.inlier_ratio,
               result.up_odom.x(), result.up_odom.y(), result.up_std_rad);
  write_covariance(file, result.P_odom_base);
  std::fputc('\n', file);
}

void write_silence_header(std::FILE* file) {
  std::fputs("timestamp_ns,state,cause,x_m,y_m,z_m,qx,qy,qz,qw", file);
  write_covariance_names(file);
  std::fputc('\n', file);
}

/// A step where no scan had come for a while: what is believed of the pose, and how much.
void write_silence_row(std::FILE* file, const odometry::OdometryResult& step) {
  const Eigen::Vector3d& p = step.T_odom_base.translation();
  const Eigen::Quaterniond q(step.T_odom_base.rotation());
  std::fprintf(file, "%lld,%s,%d,%.6f,%.6f,%.6f,%.9f,%.9f,%.9f,%.9f", static_cast<long long>(step.stamp.time_since_epoch().count()),
               name_of(step.state), static_cast<int>(step.cause), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  write_covariance(file, step.P_odom_base);
  std::fputc('\n', file);
}

}  // namespace

ProductWriter::ProductWriter(const std::filesystem::path& directory, double map_spacing_m)
    : map_file_(directory / "map.ply"),
      map_spacing_m_(map_spacing_m),
      odometry_(open(directory / "odometry.tum")),
      trajectory_(open(directory / "trajectory.tum")),
      scans_(open(directory / "scans.csv")),
      silence_(open(directory / "silence.csv")),
      motions_(open(directory / "motions.csv")),
      map_(map_file_),
      seen_(static_cast<float>(map_spacing_m)) {
  write_scan_header(scans_.get());
  write_silence_header(silence_.get());
}

void ProductWriter::add(const ScanRecord& record, const scan::DeskewedScan& scan, const odometry::MotionStep& motion) {
  const odometry::OdometryResult& result = record.odometry;
  recording::write_tum_line(odometry_.get(), result.stamp, result.T_odom_base);
  poses_.push_back({result.stamp, result.T_odom_base});
  map_points_of_scan_.push_back(0);
  write_scan_row(scans_.get(), result);
  motion_log_.add(result.stamp, motion);
  if (!result.map_updated && result.scan_index != 0) {
    return;
  }
  const Eigen::Matrix3f R = result.T_odom_imu.rotation().cast<float>();
  const Eigen::Vector3f t = result.T_odom_imu.translation().cast<float>();
  for (const Eigen::Vector3f& p_imu : scan.map_points_imu) {
    const Eigen::Vector3f p_map = R * p_imu + t;
    if (map_.points() < kMaxMapPoints && seen_.admit(p_map)) {
      map_.write(p_map);
      ++map_points_of_scan_.back();
      picture_points_.offer(p_map);
    }
  }
}

void ProductWriter::correct_map(const evaluation::Trajectory& odometry) {
  const std::filesystem::path in_odom = map_file_.string() + ".odom";
  std::filesystem::rename(map_file_, in_odom);
  storage::PlyReader reader(in_odom);
  storage::PlyWriter corrected(map_file_);
  SeenCubes seen(static_cast<float>(map_spacing_m_));
  picture_points_ = plot::EvenSample(kMaxPicturePoints);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    const geometry::Se3 T_map_odom = poses_[i].T * odometry[i].T.inverse();
    for (std::uint32_t k = 0; k < map_points_of_scan_[i]; ++k) {
      const Eigen::Vector3f p_map = (T_map_odom * reader.read().cast<double>()).cast<float>();
      if (seen.admit(p_map)) {
        corrected.write(p_map);
        picture_points_.offer(p_map);
      }
    }
  }
  corrected.close();
  std::filesystem::remove(in_odom);
}

void ProductWriter::add_silent(const odometry::OdometryResult& step) { write_silence_row(silence_.get(), step); }

void ProductWriter::close(const mapping::CorrectedPath* path) {
  const evaluation::Trajectory odometry = poses_;
  if (path != nullptr) {
    for (evaluation::TimedPose& pose : poses_) {
      pose.T = path->T_map_base(pose.stamp, pose.T);
    }
  }
  for (const evaluation::TimedPose& pose : poses_) {
    recording::write_tum_line(trajectory_.get(), pose.stamp, pose.T);
  }
  write_motions(motions_.get(), motion_log_.claims());
  for (auto* stream : {&odometry_, &trajectory_, &scans_, &silence_, &motions_}) {
    if (std::fclose(stream->release()) != 0) {
      throw std::runtime_error(std::string("a product could not be written whole: ") + std::strerror(errno));
    }
  }
  map_.close();
  if (path != nullptr) {
    correct_map(odometry);
  }
}

TimeSummary summary_of(std::vector<double> values) {
  if (values.empty()) {
    return {};
  }
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
  };
  return {at(0.5), at(0.95), at(0.99), values.back()};
}

evaluation::Trajectory trajectory_of(const Run& run) {
  evaluation::Trajectory trajectory;
  for (const ScanRecord& record : run.scans) {
    trajectory.push_back({record.odometry.stamp, record.odometry.T_odom_base});
  }
  return trajectory;
}

double path_m(const Run& run) { return evaluation::path_length_m(trajectory_of(run)); }

std::string report_json(const Recording& recording, const Run& run, const MappingSummary* mapping, const std::string& accuracy) {
  std::uint64_t small = 0;
  std::uint64_t recovery = 0;
  std::uint64_t won = 0;
  std::uint64_t unprocessed = run.scans_seen - run.scans.size() - run.scans_before_start;
  for (const ScanRecord& record : run.scans) {
    small += record.odometry.swarm.particles != 0 && !record.odometry.swarm.recovery ? 1 : 0;
    recovery += record.odometry.swarm.recovery ? 1 : 0;
    won += record.odometry.swarm.swarm_won ? 1 : 0;
  }
  ordered_json report;
  report["recording"] = recording.name.string();
  report["state"] = run.scans.empty() ? "STARTING" : name_of(run.scans.back().odometry.state);
  report["scans"] = run.scans.size();
  report["scans_dropped"] = unprocessed;
  report["scans_before_start"] = run.scans_before_start;
  report["path_m"] = std::round(1e3 * path_m(run)) / 1e3;
  report["packets"] = json_of(run.packets);
  report["blocks"] = json_of(run.blocks);
  report["imu"] = json_of(run.imu);
  report["wheel"] = json_of(run.wheel);
  if (run.gnss) {
    report["gnss"] = json_of(*run.gnss);
  }
  report["clock"] = {{"steps", run.clock.steps}, {"roll_overs", run.clock.roll_overs}, {"skew_ppm", 1e6 * run.clock.skew},
                     {"residual_mean_us", 1e-3 * static_cast<double>(run.clock.residual_mean.count())},
                     {"residual_max_us", 1e-3 * static_cast<double>(run.clock.residual_max.count())}};
  report["cpu_ms_per_scan"] = json_of(stage(run, [](const ScanRecord& r) { return r.decode_ms + r.times.preprocess_ms + r.times.odometry_ms; }));
  report["stage_ms"] = {{"decode", json_of(stage(run, [](const ScanRecord& r) { return r.decode_ms; }))},
                        {"preprocess", json_of(stage(run, [](const ScanRecord& r) { return r.times.preprocess_ms; }))},
                        {"odometry", json_of(stage(run, [](const ScanRecord& r) { return r.times.odometry_ms; }))}};
  report["rss_max_mb"] = std::round(10.0 * peak_rss_mb()) / 10.0;
  report["realtime_factor"] = run.wall_s > 0.0 ? std::round(100.0 * run.recording_s / run.wall_s) / 100.0 : 0.0;
  report["swarm"] = {{"small", small}, {"recovery", recovery}, {"won", won}};
  report["loops"] = json_of(mapping != nullptr ? mapping->loops : mapping::LoopCounts{});
  if (mapping != nullptr) {
    report["stage_ms"]["mapping"] = json_of(summary_of(mapping->ms));
    report["mapping"] = {{"keyframes", mapping->keyframes}, {"retired", mapping->retired}, {"corrections", mapping->corrections}};
  }
  report["states"] = states_of(run);
  if (run.alignment) {
    report["start"] = {{"at_rest", run.alignment->at_rest}, {"tilt_std_deg", run.alignment->tilt_std_rad * 180.0 / M_PI}};
  }
  if (run.alignment && !run.scans.empty()) {
    const odometry::OdometryResult& last = run.scans.back().odometry;
    const double tilt_rad = std::atan2(last.up_odom.head<2>().norm(), last.up_odom.z());
    report["gravity"] = {{"odom_tilt_deg", tilt_rad * 180.0 / M_PI}, {"std_deg", last.up_std_rad * 180.0 / M_PI}};
  }
  report["lidar_imu"] = json_of(run.agreement.lidar_imu);
  report["lean"] = json_of(run.agreement.gravity);
  if (!accuracy.empty()) {
    report["accuracy"] = ordered_json::parse(accuracy);
  }
  report["remarks"] = run.remarks;
  return report.dump(2) + "\n";
}

}  // namespace slamd::replay
