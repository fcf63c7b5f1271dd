#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/study/disturbance.hpp"

namespace slamd::study {

/// registration: one scan from a wrong prior. tracking: a run of kRunScans scans whose prediction
/// goes wrong again and again, or whose inertial sensor is bad; the map grows meanwhile.
enum class Experiment { kRegistration, kTracking };

/// What is studied.
struct StudyConfig {
  std::size_t n = 100;     // draws, or runs, a cell
  std::uint64_t seed = 1;  // of the worlds, the drives and all draws
  std::size_t drives = 2;  // a world, which the draws are spread over
  double drive_s = 30.0;
  int threads = 1;  // the result is the same for any number
  std::vector<std::string> worlds;
  std::vector<std::string> overrides = {};  // "key=value" of slamd's configuration
  std::vector<std::string> estimators = {};  // empty: all
  bool registration = true;            // which experiments,
  bool tracking = true;
  bool not_told = true;  // and which priors
  bool told = true;

  bool has(Experiment experiment, bool prior_told) const;
  bool has(const std::string& estimator) const;
};

/// A registration has succeeded when it ends so near to the reference.
inline constexpr double kSuccess_m = 0.10;
inline constexpr double kSuccess_deg = 1.0;

inline constexpr std::size_t kRunScans = 32;
inline constexpr std::size_t kBurstEvery = 8;  // scans

/// A run is lost when it is farther than this from the reference in kBurstEvery scans in a row, or
/// at its end.
inline constexpr double kLost_m = 0.5;
inline constexpr double kLost_deg = 5.0;

/// What makes one column of numbers: an experiment, how wrong the prior is, whether the filter is
/// told, and the filter.
struct CellKey {
  Experiment experiment = Experiment::kRegistration;
  std::string condition;  // the error's size, or "degraded IMU"
  bool told = false;
  std::string estimator;
};

/// What came out. Hits are successes of a registration, and lost runs of tracking.
struct Cell {
  CellKey key;
  std::string world;
  std::size_t n = 0;
  std::size_t hits = 0;
  double median_error_m = 0.0;  // at the end, of successes, or of runs that were not lost
};

/// All cells of one world.
struct WorldResult {
  std::string world;
  double reference_ape_m = 0.0;  // the worst of its drives
  std::vector<Cell> cells;
};

/// The estimators, in the order of the tables; "literal PSF, slices" in registrations only.
const std::vector<std::string>& estimator_names(Experiment experiment);

/// The sizes of errors, or kinds of runs, in the order of the tables.
std::vector<std::string> conditions(Experiment experiment);

/// Runs the study. `done(result)` is called for each world, in the order of the configuration, as
/// soon as it and those before it are finished.
void run_study(const StudyConfig& config,
               const std::function<void(double)>& progress,
               const std::function<void(const WorldResult&)>& done);

}  // namespace slamd::study
