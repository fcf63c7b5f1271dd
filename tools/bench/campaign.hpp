#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/simulate/drive.hpp"

namespace slamd::bench {

/// A list of drives to be mapped and measured.
struct Campaign {
  std::string name;
  std::vector<simulate::Drive> drives;
};

/// quick: six worlds, two sensors, 60 s each. full: three seeds, five minutes each.
Campaign quick_campaign();
Campaign full_campaign();

/// What came out of one drive.
struct Outcome {
  std::string key;  // world/lidar/seed/duration, and what was overridden
  std::string world;
  std::string lidar;
  std::uint64_t seed = 0;
  double duration_s = 0.0;
  double path_m = 0.0;
  std::uint64_t scans = 0;
  std::uint64_t scans_tracking = 0;
  std::string state;  // at the end
  double ape_rmse_m = 0.0;  // SE(3)-aligned; by yaw where the path is straight
  double ape_max_m = 0.0;
  double end_drift_m = 0.0;
  double tilt_mean_deg = 0.0;
  double cpu_median_ms = 0.0;  // per scan
  double cpu_p99_ms = 0.0;
  double wall_s = 0.0;
  std::vector<double> error_m;  // of the position, once a second
};

/// Names a drive, mapped with "key=value" overrides, within campaigns.
std::string key_of(const simulate::Drive& drive, const std::vector<std::string>& overrides);

/// Simulates a drive, maps it and measures the result against its truth; no file is written.
Outcome run_drive(const simulate::Drive& drive, const std::vector<std::string>& overrides,
                  const std::function<void(double)>& progress);

/// Runs what DIR/results.jsonl does not hold yet and adds it there, drive by drive; returns all outcomes in the
/// campaign's order. Errors: RecordingError, std::runtime_error.
std::vector<Outcome> run_campaign(const Campaign& campaign, const std::filesystem::path& directory,
                                  const std::vector<std::string>& overrides,
                                  const std::function<void(double)>& progress);

/// Reads results; lines that were cut off are left out.
std::vector<Outcome> read_results(const std::filesystem::path& file);

}  // namespace slamd::bench
