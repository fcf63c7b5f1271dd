#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.hpp"
#include "core/scan/preprocessor.hpp"
#include "drivers/storage/ply_writer.hpp"
#include "tools/plot/even_sample.hpp"
#include "tools/replay/motion_log.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/seen_cubes.hpp"

namespace slamd::mapping {
class CorrectedPath;
}

namespace slamd::replay {

struct MappingSummary;

/// Writes a run's products while it goes on: odometry.tum, scans.csv, silence.csv, map.ply, and at its end motions.csv and
/// trajectory.tum.
///
/// map.ply holds one point of each cube of the map's spacing, in the order in which they were seen. Where the map was
/// corrected it is written again at the end, each point where the correction of its scan puts it, thinned anew.
class ProductWriter {
 public:
  ProductWriter(const std::filesystem::path& directory, double map_spacing_m);

  void add(const ScanRecord& record, const scan::DeskewedScan& scan, const odometry::MotionStep& motion);
  void add_silent(const odometry::OdometryResult& step);

  /// `path` has the corrections; nullptr: map is odom.
  void close(const mapping::CorrectedPath* path);

  /// The poses in map, after close(): T_map_base of each scan.
  const evaluation::Trajectory& trajectory() const { return poses_; }

  /// What the run says of its motions.
  const std::vector<evaluation::MotionClaim>& motions() const { return motion_log_.claims(); }

  /// A thinned copy of the map for pictures.
  const std::vector<Eigen::Vector3f>& picture_points() const { return picture_points_.points(); }

 private:
  static constexpr std::size_t kMaxMapPoints = 20'000'000;
  static constexpr std::size_t kMaxPicturePoints = 2'000'000;

  void correct_map(const evaluation::Trajectory& odometry);

  std::filesystem::path map_file_;
  double map_spacing_m_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> odometry_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> trajectory_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> scans_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> silence_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> motions_;
  MotionLog motion_log_;
  storage::PlyWriter map_;
  SeenCubes seen_;
  plot::EvenSample picture_points_{kMaxPicturePoints};
  evaluation::Trajectory poses_;                  // of each scan: in odom, from close() on in map
  std::vector<std::uint32_t> map_points_of_scan_;  // how many of map.ply
};

/// Returns report.json for a run; `mapping` is nullptr where it was off, `accuracy` what evaluation found, as a JSON object, or
/// empty.
std::string report_json(const Recording& recording, const Run& run, const MappingSummary* mapping, const std::string& accuracy);

/// Returns the poses of a run: T_odom_base.
evaluation::Trajectory trajectory_of(const Run& run);

/// Length of the path of a run.  Units: m.
double path_m(const Run& run);

/// Summarises a list of times.
struct TimeSummary {
  double median = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

TimeSummary summary_of(std::vector<double> values);

}  // namespace slamd::replay
