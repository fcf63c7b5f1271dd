#pragma once

#include <optional>

#include "core/inertial/nav_state.hpp"
#include "core/odometry/odometry.hpp"
#include "core/odometry/odometry_config.hpp"
#include "core/sensor/imu_buffer.hpp"

namespace slamd::stages {

/// What the odometry knows after a scan: where the pose stage goes on from.
struct Anchor {
  inertial::NavState state;
  inertial::Covariance P = inertial::Covariance::Identity();
  odometry::State odometry_state = odometry::State::kStarting;
  odometry::Cause cause = odometry::Cause::kAligning;
  std::uint8_t weak_axes = 0;
  std::uint32_t epoch = 1;  // of odom: another one than before is another odom
  std::uint32_t map_restarts = 0;
  geometry::Matrix6d shared_errors = geometry::Matrix6d::Zero();  // of T_odom_base, beside P: Odometry::shared_errors
};

/// The pose at one inertial sample.
/// Frames: T_odom_base; v in odom; rate in base.  Covariances: of (δp, δθ) of base, and of its velocity.
struct PredictedPose {
  Stamp stamp{};
  geometry::Se3 T_odom_base;
  Eigen::Vector3d v_odom_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_base_radps = Eigen::Vector3d::Zero();
  geometry::Matrix6d P_odom_base = geometry::Matrix6d::Zero();
  Eigen::Matrix3d P_velocity_odom = Eigen::Matrix3d::Zero();
  std::uint32_t reset_counter = 0;
  odometry::State state = odometry::State::kStarting;
  odometry::Cause cause = odometry::Cause::kAligning;
  std::uint8_t weak_axes = 0;
};

/// The pose at every inertial sample: goes on from the odometry's last state, and blends its updates in.
///
/// A scan update is blended over one scan period, so that the pose stays continuous; a correction of more than 3σ or
/// kLargeCorrection_m is taken at once and increments reset_counter (design.md, "Frames, time, signs"); so does a new
/// epoch of odom.
/// Real-time: allocates in the constructor only; O(17³) per sample, and once per scan for each sample since its end.
class PoseStage {
 public:
  static constexpr double kLargeCorrection_m = 0.2;
  /// So long after the last scan the pose lives on the inertial sensor alone, and says so.
  static constexpr Duration kNoScan = std::chrono::milliseconds(500);

  PoseStage(const odometry::OdometryConfig& config, Duration blend);

  /// Takes the odometry's newest state in.
  void add_anchor(const Anchor& anchor);

  /// Takes an inertial sample in; returns the pose there, once there is an anchor.
  std::optional<PredictedPose> add_imu(sensor::ImuSample sample);

  /// Returns the pose at the anchor itself: what goes out where no inertial sensor says more.
  std::optional<PredictedPose> at_anchor() const;

 private:
  void advance(const sensor::ImuSample& before, const sensor::ImuSample& after);
  PredictedPose shown(const inertial::NavState& state, const Eigen::Vector3d& rate_imu_radps) const;
  inertial::NavState blended(const inertial::NavState& state) const;

  odometry::OdometryConfig config_;
  Duration blend_;
  sensor::ImuBuffer imu_;
  bool has_anchor_ = false;
  Anchor anchor_;
  inertial::NavState state_;  // predicted from the anchor up to the newest sample
  inertial::Covariance P_ = inertial::Covariance::Identity();
  // What the last update changed, and has not been shown yet: fades over blend_.
  geometry::Vector6d pending_ = geometry::Vector6d::Zero();
  Eigen::Vector3d pending_velocity_ = Eigen::Vector3d::Zero();
  Stamp blend_begin_{};
  std::uint32_t reset_counter_ = 0;
};

}  // namespace slamd::stages
