#pragma once

#include <array>
#include <optional>

#include "core/base/bounded_vector.hpp"
#include "core/geometry/se3.hpp"
#include "core/inertial/start_up_alignment.hpp"
#include "core/odometry/odometry_config.hpp"
#include "core/scan/preprocessor.hpp"
#include "core/sensor/imu_buffer.hpp"
#include "core/sensor/scan.hpp"
#include "core/sensor/stamp_gate.hpp"
#include "core/sensor/wheel_sample.hpp"

namespace slamd::stages {

/// What the odometry tells the preprocess stage after a scan.
struct Feedback {
  std::uint64_t sequence = 0;
  inertial::NavState state;
  bool indoor = false;
};

/// A scan on its way from preprocess to odometry, with what belongs to it.
struct PreprocessedScan {
  explicit PreprocessedScan(const odometry::OdometryConfig& config);

  std::uint64_t sequence = 0;                   // counts the scans handed over, from 1
  std::uint32_t epoch = 1;                      // counts odom's beginnings
  std::optional<inertial::Alignment> start;     // on the first of an epoch: where odom begins
  std::optional<Stamp> start_without_imu;       // the same where there is no inertial sensor
  scan::DeskewedScan deskewed;
  bool without_scan = false;                    // none has come for a while: of `deskewed` only `end` counts
  BoundedVector<sensor::ImuSample> imu;         // accepted since the scan before, so that no scan loses any
  BoundedVector<sensor::WheelSample> wheels;    // since the scan before
  Stamp received{};                             // arrival of the packet that completed the scan
  double preprocess_ms = 0.0;                   // CPU time
};

/// The preprocess stage: levels odom, deskews and extracts features.
///
/// Deskew uses the state after scan k−2: the latest that is certain to be known when scan k is complete and scan k−1
/// is still in the odometry. So a replay gives what the daemon gave.
/// Real-time: allocates in the constructor only; preprocess thread only.
class PreprocessStage {
 public:
  /// How long a scan waits for the inertial samples up to its end, in device time.
  static constexpr Duration kImuPatience = std::chrono::milliseconds(20);
  /// Scans that began late or have lost packets which a start without an inertial sensor lets pass before it takes one.
  static constexpr int kIncompletePatience = 10;

  /// So long after a scan's end another one should have come; then the odometry goes on without, a step at a time, and
  /// stays behind the newest sample by what a scan is long, and late.
  static constexpr Duration kSilence = std::chrono::milliseconds(650);
  static constexpr Duration kSilentStep = std::chrono::milliseconds(100);
  static constexpr Duration kSilentLag = std::chrono::milliseconds(350);
  /// While there is no scan to start with, odom is levelled anew so often: what it was level with may have been moved.
  static constexpr Duration kLevelAgain = std::chrono::seconds(1);
  static constexpr Duration kWheelLeap = std::chrono::seconds(1);

  explicit PreprocessStage(const odometry::OdometryConfig& config);

  /// Takes an inertial sample in; levels odom with the first ones.
  void add_imu(sensor::ImuSample sample);

  /// Hands a sample of the wheels on, with the next scan. One that leaps ahead by more than kWheelLeap waits until the
  /// next one tells that it is no wild stamp.
  void add_wheel(const sensor::WheelSample& sample);

  /// Takes in what the odometry found. What is left of an epoch before is of no use.
  void add_feedback(const Feedback& feedback) {
    if (feedback.sequence > first_.sequence) {
      history_[feedback.sequence % history_.size()] = feedback;
    }
  }

  /// Begins an epoch: odom is levelled anew, and the first scan after that carries the start.
  void restart(std::uint32_t epoch);

  /// Tells whether a scan can be processed now: the inertial samples reach its end, or it has waited enough.
  bool ready_for(const sensor::Scan& scan, Stamp now) const;

  /// Processes a scan into `out`; returns false while starting (the scan belongs to the time before the first state), and
  /// for one so late that the odometry has gone on without it.
  bool process(const sensor::Scan& scan, PreprocessedScan& out);

  /// Makes a step without a scan into `out`, if it is time for one. Call until it returns false.
  bool go_on_without_scan(PreprocessedScan& out);

  const sensor::ImuBuffer& imu() const { return imu_; }
  bool started() const { return started_; }
  const std::optional<inertial::Alignment>& alignment() const { return alignment_; }

  /// Scans that were deskewed with an older state than k−2: the odometry was late.
  std::uint64_t late_feedback() const { return late_feedback_; }

  /// Samples of the wheels that were refused for their stamps: old, or far ahead.
  std::uint64_t wheels_refused() const { return wheels_refused_; }

 private:
  void begin_hearing_anew();
  void hand_on(const sensor::WheelSample& sample);
  void level(const sensor::ImuSample& sample);
  bool start(const sensor::Scan& scan, PreprocessedScan& out);
  Stamp next_heard() const;
  void note_lateness(const sensor::Scan& scan);
  void hand_over_samples(Stamp to, PreprocessedScan& out);
  const Feedback& feedback_at(std::uint64_t sequence) const;
  void deskew_and_extract(const sensor::Scan& scan, PreprocessedScan& out);

  odometry::OdometryConfig config_;
  geometry::Se3 T_imu_lidar_;
  sensor::ImuBuffer imu_;
  inertial::StartUpAlignment aligner_;
  std::optional<inertial::Alignment> alignment_;
  int incomplete_passed_over_ = 0;
  bool started_ = false;            // odom of this epoch is level
  std::uint32_t epoch_ = 1;
  std::uint64_t sequence_ = 0;      // of the last scan handed over
  std::uint64_t late_feedback_ = 0;
  sensor::StampGate wheel_gate_{kWheelLeap, sensor::StampGate::First::kMustBeConfirmed};
  std::optional<sensor::WheelSample> wheel_ahead_;  // a leap that waits
  std::uint64_t wheels_refused_ = 0;
  Stamp heard_{};                   // newest sample of the inertial sensor or the wheels
  Stamp scan_end_{};                // of the last scan handed over
  Duration lateness_{};             // by which scans come later than the samples of their end; the most of late
  Stamp reached_{};                 // the same, or of the last step without one
  Feedback first_;                  // stands for all before the epoch's first scan
  std::array<Feedback, 4> history_;  // by sequence
  // scratch, sized once
  BoundedVector<sensor::ImuSample> pending_imu_;
  BoundedVector<sensor::WheelSample> pending_wheels_;
  scan::ScanMotion motion_;
  scan::Preprocessor preprocessor_;
};

/// Returns the samples that bracket [from, to]: one at or before, one at or after, and all between. Empty when
/// none reaches into the interval.
std::span<const sensor::ImuSample> bracket(std::span<const sensor::ImuSample> samples, Stamp from, Stamp to);

/// Appends; when full, the older half makes room, which costs next to nothing a sample.
template <typename Sample>
void push_newest(BoundedVector<Sample>& samples, const Sample& sample) {
  if (samples.full()) {
    const auto kept = samples.view().last(samples.size() / 2);
    samples.assign(kept);
  }
  samples.push_back(sample);
}

/// CPU time of the calling thread.  Units: ms.
double thread_cpu_ms();

}  // namespace slamd::stages
