#include "daemon/stages/preprocess_stage.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

namespace slamd::stages {

using sensor::ImuSample;

namespace {

/// Inertial samples that one scan, or a step without one, carries to the odometry: some seconds even at 1 kHz.
constexpr std::size_t kMaxImuPerScan = 4096;
/// Slower wheels may be noise.
constexpr double kTurningWheels_mps = 0.05;
/// The same of the wheels: ten seconds at 100 Hz.
constexpr std::size_t kMaxWheelsPerScan = 1024;

}  // namespace

double thread_cpu_ms() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

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

PreprocessedScan::PreprocessedScan(const odometry::OdometryConfig& config)
    : deskewed(config.preprocess), imu(kMaxImuPerScan), wheels(kMaxWheelsPerScan) {}

PreprocessStage::PreprocessStage(const odometry::OdometryConfig& config)
    : config_(config),
      T_imu_lidar_(config.T_base_imu.inverse() * config.T_base_lidar),
      imu_(sensor::ImuBufferConfig{}),
      aligner_(config.start_up),
      pending_imu_(kMaxImuPerScan),
      pending_wheels_(kMaxWheelsPerScan),
      motion_(config.preprocess.longest_scan),
      preprocessor_(config.preprocess) {}

void PreprocessStage::add_imu(ImuSample sample) {
  sample.stamp -= config_.imu_offset;
  const std::uint64_t restarts = imu_.counts().restarts;
  if (!config_.use_imu || !imu_.push(sample)) {
    return;
  }
  if (imu_.counts().restarts != restarts) {
    pending_imu_.clear();
    begin_hearing_anew();
  }
  push_newest(pending_imu_, sample);  // not started yet, or nobody takes them: the odometry needs the newest
  heard_ = std::max(heard_, sample.stamp);
  level(sample);
}

/// What was heard last was wild, or the clock went back: what was levelled with it is of no use.
void PreprocessStage::begin_hearing_anew() {
  heard_ = Stamp{};
  lateness_ = Duration{};
  aligner_ = inertial::StartUpAlignment(config_.start_up);
  if (!started_) {
    alignment_.reset();
  }
}

void PreprocessStage::level(const ImuSample& sample) {
  if (started_ || (alignment_ && sample.stamp - alignment_->state.stamp < kLevelAgain)) {
    return;
  }
  if (const auto alignment = aligner_.add(sample, config_.T_base_imu)) {
    alignment_ = alignment;
    aligner_ = inertial::StartUpAlignment(config_.start_up);
  }
}

void PreprocessStage::add_wheel(const sensor::WheelSample& sample) {
  const sensor::StampVerdict verdict = wheel_gate_.judge(sample.stamp);
  if (verdict == sensor::StampVerdict::kAhead) {
    wheels_refused_ += wheel_ahead_ ? 1 : 0;
    wheel_ahead_ = sample;
    return;
  }
  if (verdict == sensor::StampVerdict::kOld) {
    ++wheels_refused_;
    return;
  }
  if (verdict == sensor::StampVerdict::kSteppedBack) {
    pending_wheels_.clear();
    heard_ = Stamp{};
    lateness_ = Duration{};
  }
  if (const auto ahead = std::exchange(wheel_ahead_, std::nullopt)) {
    if (verdict == sensor::StampVerdict::kInOrder && ahead->stamp < sample.stamp) {
      hand_on(*ahead);
    } else {
      ++wheels_refused_;
    }
  }
  hand_on(sample);
}

void PreprocessStage::hand_on(const sensor::WheelSample& sample) {
  if (std::abs(sample.speed_mps) > kTurningWheels_mps) {
    aligner_.note_moving();
  }
  heard_ = std::max(heard_, sample.stamp);
  push_newest(pending_wheels_, sample);
}

bool PreprocessStage::ready_for(const sensor::Scan& scan, Stamp now) const {
  return !config_.use_imu || (!imu_.empty() && imu_.newest().stamp >= scan.end) || now >= scan.end + kImuPatience;
}

void PreprocessStage::restart(std::uint32_t epoch) {
  epoch_ = epoch;
  started_ = false;
  incomplete_passed_over_ = 0;
  alignment_.reset();
  aligner_ = inertial::StartUpAlignment(config_.start_up);
}

bool PreprocessStage::start(const sensor::Scan& scan, PreprocessedScan& out) {
  if (!config_.use_imu) {
    // The first scan begins wherever the sensor happens to look: on a map of that sector the next one would settle askew.
    if (!scan.complete && incomplete_passed_over_ < kIncompletePatience) {
      ++incomplete_passed_over_;
      return false;
    }
    out.start_without_imu = scan.end;
    first_.state = inertial::NavState{};
    first_.state.stamp = scan.end;
  } else if (alignment_ && alignment_->state.stamp <= scan.begin) {
    out.start = alignment_;
    if (!alignment_->at_rest && !pending_wheels_.empty()) {
      const double speed_mps = pending_wheels_[pending_wheels_.size() - 1].speed_mps;
      out.start = inertial::with_wheel_speed(*alignment_, speed_mps, config_.T_base_imu);
    }
    first_.state = out.start->state;
  } else {
    return false;
  }
  started_ = true;
  scan_end_ = reached_ = Stamp{};
  first_.sequence = sequence_;
  first_.indoor = config_.environment == odometry::Environment::kIndoor;
  history_.fill(first_);
  return true;
}

const Feedback& PreprocessStage::feedback_at(std::uint64_t sequence) const {
  for (std::uint64_t back = 0; back < history_.size() && first_.sequence + back <= sequence; ++back) {
    const Feedback& feedback = history_[(sequence - back) % history_.size()];
    if (feedback.sequence == sequence - back) {
      return feedback;
    }
  }
  return first_;
}

bool PreprocessStage::process(const sensor::Scan& scan, PreprocessedScan& out) {
  out.start.reset();
  out.start_without_imu.reset();
  out.without_scan = false;
  if (!started_ && !start(scan, out)) {
    return false;
  }
  note_lateness(scan);
  if (sequence_ != first_.sequence && scan.end <= reached_) {  // an epoch's first scan may end at any time, 0 among them
    return false;
  }
  const double begin_ms = thread_cpu_ms();
  scan_end_ = reached_ = scan.end;
  hand_over_samples(scan.end, out);
  deskew_and_extract(scan, out);
  out.preprocess_ms = thread_cpu_ms() - begin_ms;
  return true;
}

// What a silence has cut off ends when it began: that is no lateness of the LiDAR's.
void PreprocessStage::note_lateness(const sensor::Scan& scan) {
  const Duration late = heard_ - scan.end;
  const Duration faded = lateness_ - lateness_ / 128;
  lateness_ = scan.complete || late < kSilence ? std::max(late, faded) : faded;
}

bool PreprocessStage::go_on_without_scan(PreprocessedScan& out) {
  const Stamp newest = heard_ - lateness_;
  const auto is_time_for = [&](Stamp step) { return newest >= step + kSilentLag; };
  if (!started_ || newest < scan_end_ + kSilence || !is_time_for(reached_ + kSilentStep)) {
    return false;
  }
  // Over a time of which no sensor tells in one step: see Odometry.
  const Stamp heard = next_heard();
  const Stamp next = heard - reached_ > inertial::kLongestBridge ? heard : reached_ + kSilentStep;
  if (!is_time_for(next)) {
    return false;
  }
  out.start.reset();
  out.start_without_imu.reset();
  out.without_scan = true;
  out.deskewed.end = reached_ = next;
  hand_over_samples(next, out);
  imu_.drop_before(feedback_at(sequence_ < 2 ? 0 : sequence_ - 2).state.stamp);
  out.preprocess_ms = 0.0;
  return true;
}

/// The first sample after what was reached; at the latest the newest.
Stamp PreprocessStage::next_heard() const {
  Stamp heard = heard_;
  for (const sensor::WheelSample& wheel : pending_wheels_) {
    heard = wheel.stamp > reached_ ? std::min(heard, wheel.stamp) : heard;
  }
  const auto samples = imu_.samples();
  const auto after = std::ranges::upper_bound(samples, reached_, {}, &ImuSample::stamp);
  return after == samples.end() ? heard : std::min(heard, after->stamp);
}

void PreprocessStage::hand_over_samples(Stamp to, PreprocessedScan& out) {
  out.sequence = ++sequence_;
  out.epoch = epoch_;
  out.imu.assign(pending_imu_.view());
  pending_imu_.clear();
  // Those after it are the next one's.
  auto* const late = std::partition_point(pending_wheels_.begin(), pending_wheels_.end(),
                                         [&](const sensor::WheelSample& wheel) { return wheel.stamp <= to; });
  out.wheels.assign({pending_wheels_.begin(), late});
  pending_wheels_.resize(static_cast<std::size_t>(std::move(late, pending_wheels_.end(), pending_wheels_.begin()) -
                                                  pending_wheels_.begin()));
}

void PreprocessStage::deskew_and_extract(const sensor::Scan& scan, PreprocessedScan& out) {
  const std::uint64_t wanted = std::max(first_.sequence, sequence_ < 2 ? 0 : sequence_ - 2);
  const Feedback& latest = feedback_at(wanted);
  late_feedback_ += latest.sequence == wanted ? 0 : 1;
  // Without samples (LiDAR only, or the sensor is silent) the scan is deskewed at constant velocity.
  const std::span<const ImuSample> samples = bracket(imu_.samples(), latest.state.stamp, scan.end);
  inertial::NavState earlier = latest.state;
  if (samples.empty()) {
    // A deskew that feeds on its own two scans old velocity rings: its characteristic polynomial has a root at −1.
    // The mean of two scans moves it to 0.7.
    const inertial::NavState& before = feedback_at(std::max(first_.sequence + 1, wanted) - 1).state;
    earlier.v_odom_imu = 0.5 * (earlier.v_odom_imu + before.v_odom_imu);
    earlier.gyro_bias = 0.5 * (earlier.gyro_bias + before.gyro_bias);
  }
  if (earlier.stamp >= scan.end || !scan.points_have_time) {
    motion_.set_still(scan.begin, scan.end);
  } else {
    motion_.predict(earlier, samples, scan.begin, scan.end);
  }
  preprocessor_.process(scan, motion_, T_imu_lidar_, config_.T_base_imu, latest.indoor, out.deskewed);
  imu_.drop_before(latest.state.stamp);
}

}  // namespace slamd::stages
