#include "daemon/stages/front_end.hpp"

#include <algorithm>
#include <ctime>

namespace slamd::stages {

using odometry::OdometryResult;
using sensor::ImuSample;

namespace {

double thread_cpu_ms() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Returns the samples that bracket [from, to]: one at or before, one at or after, and all between. Empty when
/// none reaches into the interval.
std::span<const ImuSample> bracket(std::span<const ImuSample> samples, Stamp from, Stamp to) {
  const auto before = [](const ImuSample& sample, Stamp stamp) { return sample.stamp < stamp; };
  auto first = std::lower_bound(samples.begin(), samples.end(), from, before);
  auto last = std::lower_bound(first, samples.end(), to, before);
  if (first == samples.end()) {
    return {};
  }
  if (first != samples.begin() && first->stamp > from) {
    --first;
  }
  if (last != samples.end()) {
    ++last;
  }
  return {first, last};
}

}  // namespace

FrontEnd::FrontEnd(const odometry::OdometryConfig& config)
    : config_(config),
      T_imu_lidar_(config.T_base_imu.inverse() * config.T_base_lidar),
      imu_(sensor::ImuBufferConfig{}),
      aligner_(config.start_up),
      motion_(config.preprocess.longest_scan),
      preprocessor_(config.preprocess),
      deskewed_(config.preprocess),
      odometry_(config) {}

void FrontEnd::add_imu(const ImuSample& sample) {
  if (!config_.use_imu || !imu_.push(sample) || alignment_) {
    return;
  }
  alignment_ = aligner_.add(sample, config_.T_base_imu);
}

bool FrontEnd::ready_for(const sensor::Scan& scan, Stamp now) const {
  return !config_.use_imu || (!imu_.empty() && imu_.newest().stamp >= scan.end) || now >= scan.end + kImuPatience;
}

bool FrontEnd::start_if_needed(const sensor::Scan& scan) {
  if (odometry_.started()) {
    return true;
  }
  if (!config_.use_imu) {
    // The first scan begins wherever the sensor happens to look: on a map of that sector the next one would settle askew.
    if (!scan.complete && incomplete_passed_over_ < kIncompletePatience) {
      ++incomplete_passed_over_;
      return false;
    }
    odometry_.start_without_imu(scan.end);
  } else if (alignment_ && alignment_->state.stamp <= scan.begin) {
    odometry_.start(*alignment_);
  } else {
    return false;
  }
  after_last_scan_ = after_scan_before_last_ = odometry_.state();
  return true;
}

void FrontEnd::preprocess(const sensor::Scan& scan) {
  // Without samples (LiDAR only, or the sensor is silent) the scan is deskewed at constant velocity.
  const std::span<const ImuSample> samples =
      bracket(imu_.samples(), after_scan_before_last_.stamp, scan.end);
  inertial::NavState earlier = after_scan_before_last_;
  if (samples.empty()) {
    // A deskew that feeds on its own two scans old velocity rings: its characteristic polynomial has a root at −1.
    // The mean of two scans moves it to 0.7.
    earlier.v_odom_imu = 0.5 * (earlier.v_odom_imu + v_odom_imu_before_that_);
    earlier.gyro_bias = 0.5 * (earlier.gyro_bias + gyro_bias_before_that_);
  }
  const bool first = after_scan_before_last_.stamp >= scan.end;
  if (first || !scan.points_have_time) {
    motion_.set_still(scan.begin, scan.end);
  } else {
    motion_.predict(earlier, samples, scan.begin, scan.end);
  }
  preprocessor_.process(scan, motion_, T_imu_lidar_, config_.T_base_imu, odometry_.indoor(), deskewed_);
}

std::optional<OdometryResult> FrontEnd::process(const sensor::Scan& scan) {
  if (!start_if_needed(scan)) {
    return std::nullopt;
  }
  const double begin_ms = thread_cpu_ms();
  preprocess(scan);
  const double middle_ms = thread_cpu_ms();
  const OdometryResult result =
      odometry_.process(deskewed_, bracket(imu_.samples(), odometry_.state().stamp, scan.end));
  v_odom_imu_before_that_ = after_scan_before_last_.v_odom_imu;
  gyro_bias_before_that_ = after_scan_before_last_.gyro_bias;
  after_scan_before_last_ = after_last_scan_;
  after_last_scan_ = odometry_.state();
  imu_.drop_before(after_scan_before_last_.stamp);
  times_ = {middle_ms - begin_ms, thread_cpu_ms() - middle_ms};
  return result;
}

}  // namespace slamd::stages
