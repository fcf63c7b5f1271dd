#pragma once

#include <optional>

#include "daemon/stages/odometry_stage.hpp"
#include "daemon/stages/preprocess_stage.hpp"

namespace slamd::stages {

/// CPU time of the calling thread in each stage of one scan.  Units: ms.
struct StageTimes {
  double preprocess_ms = 0.0;
  double odometry_ms = 0.0;
};

/// The preprocess and odometry stages, one after the other in one thread: a replay's form of what the daemon runs in two.
/// Real-time: allocates in the constructor only.
class FrontEnd {
 public:
  explicit FrontEnd(const odometry::OdometryConfig& config);

  void add_imu(const sensor::ImuSample& sample) { preprocess_.add_imu(sample); }

  void add_wheel(const sensor::WheelSample& sample) { preprocess_.add_wheel(sample); }

  /// Begins an epoch: odom and map anew, as soon as odom is level again.
  void restart(std::uint32_t epoch) { preprocess_.restart(epoch); }

  bool ready_for(const sensor::Scan& scan, Stamp now) const { return preprocess_.ready_for(scan, now); }

  /// Processes a scan; returns nothing while starting, and for one that comes too late.
  std::optional<odometry::OdometryResult> process(const sensor::Scan& scan);

  /// Goes on a step where no scan has come for a while; returns nothing when it is not time for one.
  std::optional<odometry::OdometryResult> go_on_without_scan();

  bool started() const { return preprocess_.started(); }
  std::uint64_t wheels_refused() const { return preprocess_.wheels_refused(); }
  const odometry::Odometry& odometry() const { return odometry_.odometry(); }
  const sensor::ImuBuffer& imu() const { return preprocess_.imu(); }
  const scan::DeskewedScan& deskewed() const { return preprocessed_.deskewed; }
  const StageTimes& times() const { return times_; }
  const std::optional<inertial::Alignment>& alignment() const { return preprocess_.alignment(); }

 private:
  PreprocessStage preprocess_;
  OdometryStage odometry_;
  PreprocessedScan preprocessed_;
  StageTimes times_;
};

}  // namespace slamd::stages
