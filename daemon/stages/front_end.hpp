#pragma once

#include <optional>
#include <span>

#include "core/geometry/se3.hpp"
#include "core/inertial/start_up_alignment.hpp"
#include "core/odometry/odometry.hpp"
#include "core/scan/preprocessor.hpp"
#include "core/sensor/imu_buffer.hpp"
#include "core/sensor/scan.hpp"

namespace slamd::stages {

/// CPU time of the calling thread in each stage of one scan.  Units: ms.
struct StageTimes {
  double preprocess_ms = 0.0;
  double odometry_ms = 0.0;
};

/// The preprocess and odometry stages, one after the other: what the daemon runs on two threads and a replay on one.
///
/// Deskew uses the state after scan k−2, so that both give the same result.
/// Real-time: allocates in the constructor only.
class FrontEnd {
 public:
  /// How long a scan waits for the inertial samples up to its end, in device time.
  static constexpr Duration kImuPatience = std::chrono::milliseconds(20);

  /// Without an inertial sensor: incomplete scans that are passed over before one of them has to do as the first.
  static constexpr int kIncompletePatience = 10;

  explicit FrontEnd(const odometry::OdometryConfig& config);

  /// Takes an inertial sample in; levels odom with the first ones.
  void add_imu(const sensor::ImuSample& sample);

  /// Tells whether a scan can be processed now: the inertial samples reach its end, or it has waited enough.
  bool ready_for(const sensor::Scan& scan, Stamp now) const;

  /// Processes a scan; returns nothing while starting (the scan belongs to the time before the first state).
  std::optional<odometry::OdometryResult> process(const sensor::Scan& scan);

  const odometry::Odometry& odometry() const { return odometry_; }
  const sensor::ImuBuffer& imu() const { return imu_; }
  const scan::DeskewedScan& deskewed() const { return deskewed_; }
  const StageTimes& times() const { return times_; }
  const std::optional<inertial::Alignment>& alignment() const { return alignment_; }

 private:
  bool start_if_needed(const sensor::Scan& scan);
  void preprocess(const sensor::Scan& scan);

  odometry::OdometryConfig config_;
  geometry::Se3 T_imu_lidar_;
  sensor::ImuBuffer imu_;
  int incomplete_passed_over_ = 0;
  inertial::StartUpAlignment aligner_;
  std::optional<inertial::Alignment> alignment_;
  inertial::NavState after_scan_before_last_;  // state k−2
  inertial::NavState after_last_scan_;         // state k−1
  Eigen::Vector3d v_odom_imu_before_that_ = Eigen::Vector3d::Zero();  // of state k−3
  Eigen::Vector3d gyro_bias_before_that_ = Eigen::Vector3d::Zero();
  scan::ScanMotion motion_;
  scan::Preprocessor preprocessor_;
  scan::DeskewedScan deskewed_;
  odometry::Odometry odometry_;
  StageTimes times_;
};

}  // namespace slamd::stages
