#pragma once

#include "core/base/bounded_vector.hpp"
#include "core/odometry/odometry.hpp"
#include "core/sensor/imu_buffer.hpp"
#include "daemon/stages/preprocess_stage.hpp"

namespace slamd::stages {

/// The odometry stage: preprocessed scans to poses.
/// Real-time: allocates in the constructor only; odometry thread only.
class OdometryStage {
 public:
  explicit OdometryStage(const odometry::OdometryConfig& config);

  /// Processes a scan.
  odometry::OdometryResult process(const PreprocessedScan& scan);

  /// Goes on where there is none.
  odometry::OdometryResult go_on_without_scan(const PreprocessedScan& step);

  /// Lets a scan pass that came too late, but for the samples and the start that it carries.
  void skip(const PreprocessedScan& scan) { take(scan); }

  /// Returns what the preprocess stage needs to know of the last scan processed.
  Feedback feedback() const { return {sequence_, odometry_.state(), odometry_.indoor()}; }

  const odometry::Odometry& odometry() const { return odometry_; }

 private:
  void take(const PreprocessedScan& scan);
  void note_done(const PreprocessedScan& scan);

  sensor::ImuBuffer imu_;
  BoundedVector<sensor::WheelSample> wheels_;  // since the last scan processed; full: the oldest are forgotten
  odometry::Odometry odometry_;
  std::uint64_t sequence_ = 0;
};

}  // namespace slamd::stages
