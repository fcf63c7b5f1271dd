#include "tools/study/psf_study.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <thread>

#include "core/evaluation/median.hpp"
#include "core/inertial/propagation.hpp"
#include "daemon/stages/preprocess_stage.hpp"
#include "tools/simulate/scenery.hpp"
#include "tools/study/ekf.hpp"
#include "tools/study/literal_psf.hpp"
#include "tools/study/plain_particle_filter.hpp"
#include "tools/study/study_odometry.hpp"

namespace slamd::study {

using geometry::Se3;
using geometry::Vector6d;
using inertial::Covariance;

namespace {

const std::string kPsf = "PSF";
const std::string kSlices = "literal PSF, slices";
const std::string kDegraded = "degraded IMU";

constexpr std::array<ErrorSize, 4> kRegistrationErrors{
    {{0.25, 2.5}, {0.5, 5.0}, {1.0, 10.0}, {1.5, 20.0}}};
constexpr std::array<ErrorSize, 3> kBursts{{{0.5, 5.0}, {1.0, 10.0}, {1.5, 20.0}}};
constexpr std::size_t kFirstScan = 40;  // of a drive: the map has been begun

/// How long a packet may be on its way: samples after that have not arrived when a scan is
/// processed.
constexpr Duration kArrived = stages::PreprocessStage::kImuPatience;

/// The cells of a world, in the order of the tables.
std::vector<CellKey> cell_keys(const StudyConfig& config) {
  std::vector<CellKey> keys;
  for (const Experiment experiment : {Experiment::kRegistration, Experiment::kTracking}) {
    for (const bool told : {false, true}) {
      if (!config.has(experiment, told)) {
        continue;
      }
      for (const std::string& condition : conditions(experiment)) {
        for (const std::string& estimator : estimator_names(experiment)) {
          if (config.has(estimator)) {
            keys.push_back({experiment, condition, told, estimator});
          }
        }
      }
    }
  }
  return keys;
}

/// What is counted in one cell.
struct Tally {
  std::size_t n = 0;
  std::size_t hits = 0;
  std::vector<double> errors_m;

  void add(const Tally& other) {
    n += other.n;
    hits += other.hits;
    errors_m.insert(errors_m.end(), other.errors_m.begin(), other.errors_m.end());
  }
};

std::uint64_t mixed(std::uint64_t seed, std::uint64_t a, std::uint64_t b) {
  return psf::Random(seed * 0x9E3779B97F4A7C15ULL + a, b).next();
}

struct PoseError {
  double position_m;
  double rotation_deg;

  bool within(double limit_m, double limit_deg) const {
    return position_m <= limit_m && rotation_deg <= limit_deg;
  }
};

PoseError error_between(const Se3& estimate, const Se3& reference) {
  return {(estimate.translation() - reference.translation()).norm(),
          geometry::angle_between(estimate.rotation(), reference.rotation()) * 180.0 / M_PI};
}

/// One drive of a world, and all estimators on it.
class DriveStudy {
 public:
  DriveStudy(RecordedDrive drive, const std::vector<CellKey>& keys, std::uint64_t seed)
      : drive_(std::move(drive)),
        seed_(seed),
        nominal_(drive_.config),
        fork_(drive_.config),
        keys_(keys) {
    estimators_["EKF"] = std::make_unique<Ekf>(drive_.config);
    estimators_["coarse-to-fine EKF"] = std::make_unique<CoarseToFineEkf>(drive_.config);
    estimators_["plain particle filter"] = std::make_unique<PlainParticleFilter>(drive_.config);
    estimators_["literal PSF"] = std::make_unique<LiteralPsf>(drive_.config, TimeSteps::kWholeScan);
    estimators_[kSlices] = std::make_unique<LiteralPsf>(drive_.config, TimeSteps::kSlices);
    estimators_[kPsf] = nullptr;  // the product's own
  }

  /// Drives along undisturbed and, at `runs` places spread over the drive, lets everyone try.
  std::vector<Tally> run(std::size_t runs, const std::function<void(double)>& progress) {
    std::vector<Tally> tallies(keys_.size());
    if (drive_.scans.size() < kFirstScan + kRunScans + 1) {
      throw std::runtime_error("a drive is too short: it has " +
                               std::to_string(drive_.scans.size()) + " scans");
    }
    const std::size_t places = drive_.scans.size() - kRunScans - kFirstScan;
    nominal_.start(drive_.start);
    std::size_t next = 0;
    for (std::size_t scan = 0; next < runs; ++scan) {
      for (; next < runs && scan == kFirstScan + next * places / runs; ++next) {
        for (std::size_t i = 0; i < keys_.size(); ++i) {
          take_part(scan, next, keys_[i], tallies[i]);
        }
        progress(static_cast<double>(next + 1) / static_cast<double>(runs));
      }
      process(nominal_, scan, drive_.imu);
    }
    return tallies;
  }

 private:
  Estimator* estimator_of(const CellKey& key) { return estimators_.at(key.estimator).get(); }

  void take_part(std::size_t scan, std::size_t run, const CellKey& key, Tally& tally) {
    if (key.experiment == Experiment::kRegistration) {
      register_scan(scan, run, key, tally);
    } else {
      track(scan, run, key, tally);
    }
  }

  /// One scan from a prior that is wrong by a drawn error: where does the update end?
  void register_scan(std::size_t scan, std::size_t run, const CellKey& key, Tally& tally) {
    const ErrorSize& size = *std::find_if(
        kRegistrationErrors.begin(), kRegistrationErrors.end(), [&](const ErrorSize& s) {
          return s.name() == key.condition;
        });
    psf::Random random(mixed(seed_, run, 1), 0);
    inertial::NavState prior = nominal_.state();
    Covariance P = nominal_.covariance();
    const Stamp end = drive_.scans[scan].end;
    inertial::propagate(prior,
                        P,
                        stages::bracket(arrived(drive_.imu, end), prior.stamp, end),
                        end,
                        drive_.config.imu_noise);
    prior.T_odom_imu =
        geometry::boxplus(drive_.T_odom_imu[scan], error_of(size, drawn_unit_error(random)));
    P += told_of(key, covariance_of(size));

    nominal_.use(estimator_of(key), mixed(seed_, run, 2));
    const odometry::UpdateResult result = nominal_.registered(drive_.scans[scan], prior, P);
    nominal_.use(nullptr, 0);

    const PoseError error = error_between(result.state.T_odom_imu, drive_.T_odom_imu[scan]);
    ++tally.n;
    if (error.within(kSuccess_m, kSuccess_deg)) {
      ++tally.hits;
      tally.errors_m.push_back(error.position_m);
    }
  }

  /// A run of scans: a fork of the odometry goes on with errors that the reference has not.
  void track(std::size_t first, std::size_t run, const CellKey& key, Tally& tally) {
    fork_ = nominal_;
    fork_.use(estimator_of(key), mixed(seed_, run, 2));
    psf::Random random(mixed(seed_, run, 3), 0);
    const auto burst = std::find_if(kBursts.begin(), kBursts.end(), [&](const ErrorSize& size) {
      return size.name() == key.condition;
    });
    Degradation wrong;
    if (burst == kBursts.end()) {
      wrong = drawn_degradation(drive_, first, kRunScans, random);
    }
    PoseError error{};
    std::size_t off_in_a_row = 0;
    for (std::size_t i = 0; i < kRunScans && off_in_a_row < kBurstEvery; ++i) {
      if (burst != kBursts.end()) {
        if (i % kBurstEvery == 0) {
          fork_.disturb(error_of(*burst, drawn_unit_error(random)),
                        told_of(key, covariance_of(*burst)));
        }
        process(fork_, first + i, drive_.imu);
      } else if (wrong.scan_dropped[i]) {
        continue;
      } else {
        fork_.disturb(Vector6d::Zero(), told_of(key, wrong.told_at(drive_.scans[first + i].end)));
        process(fork_, first + i, wrong.imu);
      }
      error = error_between(fork_.state().T_odom_imu, drive_.T_odom_imu[first + i]);
      off_in_a_row = error.within(kLost_m, kLost_deg) ? 0 : off_in_a_row + 1;
    }
    ++tally.n;
    if (off_in_a_row > 0) {
      ++tally.hits;
    } else {
      tally.errors_m.push_back(error.position_m);
    }
  }

  static Covariance told_of(const CellKey& key, const Covariance& P) {
    return key.told ? P : Covariance(Covariance::Zero());
  }

  void process(StudyOdometry& odometry,
               std::size_t scan,
               std::span<const sensor::ImuSample> imu) const {
    const Stamp end = drive_.scans[scan].end;
    odometry.process(drive_.scans[scan],
                     stages::bracket(arrived(imu, end), odometry.state().stamp, end));
  }

  static std::span<const sensor::ImuSample> arrived(std::span<const sensor::ImuSample> imu,
                                                    Stamp scan_end) {
    const auto last =
        std::partition_point(imu.begin(), imu.end(), [&](const sensor::ImuSample& sample) {
          return sample.stamp <= scan_end + kArrived;
        });
    return {imu.begin(), last};
  }

  RecordedDrive drive_;
  std::uint64_t seed_;
  StudyOdometry nominal_;
  StudyOdometry fork_;
  std::vector<CellKey> keys_;
  std::map<std::string, std::unique_ptr<Estimator>> estimators_;
};

/// What one drive has given.
struct DriveResult {
  bool finished = false;
  double ape_m = 0.0;
  std::vector<Tally> tallies;
};

/// A world's place among all, so that its draws do not depend on which others are studied.
std::size_t place_of(const std::string& world) {
  const std::vector<std::string>& all = simulate::world_names();
  return static_cast<std::size_t>(std::find(all.begin(), all.end(), world) - all.begin());
}

simulate::Drive drive_of(const StudyConfig& config, std::size_t world, std::size_t drive) {
  simulate::Drive simulated;
  simulated.world = config.worlds[world];
  simulated.seed = config.seed + drive;
  simulated.duration_s = config.drive_s;
  simulated.mixed_pixels = true;
  simulated.threads = 1;
  return simulated;
}

WorldResult world_result(const std::string& world,
                         const std::vector<CellKey>& keys,
                         std::span<const DriveResult> drives) {
  WorldResult result;
  result.world = world;
  for (const DriveResult& drive : drives) {
    result.reference_ape_m = std::max(result.reference_ape_m, drive.ape_m);
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    Tally sum;
    for (const DriveResult& drive : drives) {
      sum.add(drive.tallies[i]);
    }
    result.cells.push_back({keys[i], world, sum.n, sum.hits, evaluation::median_of(sum.errors_m)});
  }
  return result;
}

}  // namespace

bool StudyConfig::has(Experiment experiment, bool prior_told) const {
  return (experiment == Experiment::kRegistration ? registration : tracking) &&
         (prior_told ? told : not_told);
}

bool StudyConfig::has(const std::string& estimator) const {
  return estimators.empty() ||
         std::find(estimators.begin(), estimators.end(), estimator) != estimators.end();
}

const std::vector<std::string>& estimator_names(Experiment experiment) {
  static const std::vector<std::string> tracking{
      "EKF", "coarse-to-fine EKF", "plain particle filter", "literal PSF", kPsf};
  static const std::vector<std::string> registration{
      "EKF", "coarse-to-fine EKF", "plain particle filter", "literal PSF", kSlices, kPsf};
  return experiment == Experiment::kRegistration ? registration : tracking;
}

std::vector<std::string> conditions(Experiment experiment) {
  std::vector<std::string> names;
  if (experiment == Experiment::kRegistration) {
    for (const ErrorSize& size : kRegistrationErrors) {
      names.push_back(size.name());
    }
    return names;
  }
  for (const ErrorSize& size : kBursts) {
    names.push_back(size.name());
  }
  names.push_back(kDegraded);
  return names;
}

void run_study(const StudyConfig& config,
               const std::function<void(double)>& progress,
               const std::function<void(const WorldResult&)>& done) {
  const std::size_t drives = std::min(config.drives, config.n);
  const std::size_t jobs = config.worlds.size() * drives;
  const std::vector<CellKey> keys = cell_keys(config);
  std::vector<DriveResult> results(jobs);
  std::vector<double> shares(jobs);
  std::size_t worlds_done = 0;
  std::atomic<std::size_t> next_job{0};
  std::exception_ptr failure;
  std::mutex mutex;  // guards results, shares, worlds_done and failure; progress and done are
                     // called under it

  const auto run_job = [&](std::size_t job) {
    const std::size_t world = job / drives;
    const std::size_t drive = job % drives;
    DriveResult result;
    RecordedDrive recorded = record(drive_of(config, world, drive), config.overrides);
    result.ape_m = recorded.ape_rmse_m;
    const std::size_t place = place_of(config.worlds[world]);
    DriveStudy study(std::move(recorded), keys, mixed(config.seed, place, drive));
    const std::size_t runs = config.n / drives + (drive < config.n % drives ? 1 : 0);
    result.tallies = study.run(runs, [&](double share) {
      const std::lock_guard lock(mutex);
      shares[job] = share;
      double sum = 0.0;
      for (const double one : shares) {
        sum += one;
      }
      progress(sum / static_cast<double>(jobs));
    });
    result.finished = true;
    const std::lock_guard lock(mutex);
    results[job] = std::move(result);
    for (; worlds_done < config.worlds.size(); ++worlds_done) {
      const auto of_world =
          std::span<const DriveResult>(results).subspan(worlds_done * drives, drives);
      if (!std::all_of(
              of_world.begin(), of_world.end(), [](const DriveResult& r) { return r.finished; })) {
        break;
      }
      done(world_result(config.worlds[worlds_done], keys, of_world));
    }
  };
  const auto work = [&] {
    try {
      for (std::size_t job = next_job++; job < jobs; job = next_job++) {
        run_job(job);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = failure ? failure : std::current_exception();
      next_job = jobs;
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < config.threads; ++i) {
    threads.emplace_back(work);
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
}

}  // namespace slamd::study
