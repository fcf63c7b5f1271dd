#pragma once

#include <optional>

#include "daemon/bus/publisher.hpp"
#include "daemon/pipeline/rings.hpp"
#include "daemon/threads/event_ring.hpp"
#include "daemon/threads/stage_monitor.hpp"
#include "drivers/transport/host_clock.hpp"

namespace slamd::pipeline {

/// What the publish thread shows.
struct PublishCounts {
  std::uint64_t poses = 0;
  std::uint64_t scans = 0;
  std::uint32_t reset_counter = 0;
  Stamp last_pose{};  // its stamp
  std::uint32_t epoch = 0;  // of its odom; 0: none yet
  std::uint64_t scans_unmapped = 0;  // mapping was too late for them
  std::uint64_t clouds_unmapped = 0;  // scans that went to mapping without their points
  std::uint64_t scans_uncarved = 0;   // occupancy was too late for them
  // The newest pose, for the health page and for "set-pose".
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double yaw_rad = 0.0;
};

/// The publish thread: a pose for every inertial sample, a scan for every scan, map → odom on change and once a second.
/// Scans go on to mapping and to occupancy, with a copy of their points each, if there is room.
/// Threads: run_once() by one; counts() by any.
/// Real-time: allocates in the constructor only, but for LCM itself (platform: none on udpm); takes LCM's mutex.
class PublishLoop {
 public:
  PublishLoop(const odometry::OdometryConfig& config, Duration scan_period, const transport::HostClock& clock,
              Rings& rings, bus::Publisher& publisher, bool with_mapping);

  /// Hands scans on to occupancy from now on; the lidar is here in base. Before the first run_once().
  void feed_occupancy(const Eigen::Vector3d& p_base_lidar) { p_base_lidar_ = p_base_lidar; }

  /// Sleeps until there is something to say, at most `longest`, and says it.
  void run_once(Duration longest);

  PublishCounts counts() const { return shown_.load().value_or(PublishCounts{}); }
  threads::EventRing& events() { return events_; }
  const threads::StageMonitor& pose_monitor() const { return pose_monitor_; }  // arrival of the sample → sent
  const threads::StageMonitor& scan_monitor() const { return scan_monitor_; }  // last packet of the scan → in the poses

 private:
  void take_job(ScanJob& job);
  void take_imu(const ImuArrival& arrival);
  void send(const stages::PredictedPose& pose);
  void send_placement(Stamp now);
  void hand_to_mapping(const ScanJob& job);
  void hand_to_occupancy(const ScanJob& job);

  odometry::OdometryConfig config_;
  transport::HostClock clock_;
  Rings& rings_;
  bus::Publisher& publisher_;
  bool with_mapping_;
  std::optional<Eigen::Vector3d> p_base_lidar_;  // where there is occupancy
  bool gap_to_mapping_ = false;
  stages::PoseStage stage_;
  Stamp last_placement_sent_{};
  std::uint64_t placement_version_ = 0;
  std::uint64_t correction_version_ = 0;
  std::uint32_t placement_epoch_ = 0;  // of the odom that was placed last
  bus::Correction cause_ = bus::Correction::kStart;
  std::uint32_t correction_id_ = 0;
  PublishCounts counts_;
  // Written by the publish thread, read by health.
  Latest<PublishCounts> shown_;
  threads::EventRing events_;
  threads::StageMonitor pose_monitor_;
  threads::StageMonitor scan_monitor_;
};

}  // namespace slamd::pipeline
