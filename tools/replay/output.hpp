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

namespace slamd::replay {

/// Writes a run's products while it goes on: odometry.tum, trajectory.tum, scans.csv, silence.csv, map.ply, and motions.csv
/// at its end.
///
/// map.ply holds one point of each cube of the map's spacing, in the order in which they were seen.
class ProductWriter {
 public:
  ProductWriter(const std::filesystem::path& directory, double map_spacing_m);

  void add(const ScanRecord& record, const scan::DeskewedScan& scan, const odometry::MotionStep& motion);
  void add_silent(const odometry::OdometryResult& step);
  void close();

  /// What the run says of its motions.
  const std::vector<evaluation::MotionClaim>& motions() const { return motion_log_.claims(); }

  /// A thinned copy of the map for pictures.
  const std::vector<Eigen::Vector3f>& picture_points() const { return picture_points_.points(); }

 private:
  static constexpr std::size_t kMaxMapPoints = 20'000'000;
  static constexpr std::size_t kMaxPicturePoints = 2'000'000;

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> odometry_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> trajectory_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> scans_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> silence_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> motions_;
  MotionLog motion_log_;
  storage::PlyWriter map_;
  SeenCubes seen_;
  plot::EvenSample picture_points_{kMaxPicturePoints};
};

/// Returns report.json for a run; `accuracy` is what evaluation found, as a JSON object, or empty.
std::string report_json(const Recording& recording, const Run& run, const std::string& accuracy);

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
