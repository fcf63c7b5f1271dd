#include "daemon/pipeline/publish_loop.hpp"

#include "core/geometry/so3.hpp"

namespace slamd::pipeline {

using geometry::Se3;
using threads::Event;

namespace {

constexpr Duration kPlacementPeriod = std::chrono::seconds(1);
/// Without inertial samples for so long the scans' own poses go out.
constexpr Duration kImuSilent = std::chrono::milliseconds(100);

}  // namespace

PublishLoop::PublishLoop(const odometry::OdometryConfig& config, Duration scan_period, const transport::HostClock& clock,
                         Rings& rings, bus::Publisher& publisher, bool with_mapping)
    : config_(config), clock_(clock), rings_(rings), publisher_(publisher), with_mapping_(with_mapping), stage_(config, scan_period) {}

void PublishLoop::run_once(Duration longest) {
  rings_.wake_publish.wait(longest);
  while (auto job = rings_.to_publish.try_pop()) {
    take_job(**job);
    job->reset();
  }
  while (const auto arrival = rings_.imu_to_publish.try_pop()) {
    take_imu(*arrival);
  }
  send_placement(clock_.now());
  shown_.store(counts_);
}

void PublishLoop::take_job(ScanJob& job) {
  if (!job.processed) {
    return;
  }
  stage_.add_anchor(job.anchor);
  counts_.epoch = job.anchor.epoch;
  if (!config_.use_imu || job.result.stamp > counts_.last_pose + kImuSilent) {
    if (const auto pose = stage_.at_anchor()) {
      send(*pose);
    }
  }
  if (job.scan.without_scan) {
    return;
  }
  const Stamp now = clock_.now();
  scan_monitor_.add(now - job.scan.received, now);
  bus::Scan scan;
  scan.scan_index = job.result.scan_index;
  scan.stamp = job.result.stamp;
  scan.T_odom_base = job.result.T_odom_base;
  scan.T_odom_imu = job.result.T_odom_imu;
  scan.points_imu = job.scan.deskewed.map_points_imu.view();
  publisher_.publish(scan);
  rings_.scan_poses.try_push(ScanPose{job.anchor.epoch, scan.stamp, scan.T_odom_base});
  ++counts_.scans;
  if (with_mapping_) {
    hand_to_mapping(job);
  }
  if (p_base_lidar_) {
    hand_to_occupancy(job);
  }
}

void PublishLoop::hand_to_occupancy(const ScanJob& job) {
  CarveScan scan;
  scan.points = rings_.carve_pool.acquire();
  if (!scan.points) {
    ++counts_.scans_uncarved;
    return;
  }
  scan.scan = stages::scan_to_carve(job.result, job.scan.deskewed, job.anchor.epoch, *p_base_lidar_);
  scan.points->assign(job.scan.deskewed.map_points_imu.view());
  rings_.to_occupancy.try_push(std::move(scan));  // as long as the pool
  rings_.wake_occupancy.notify();
}

void PublishLoop::hand_to_mapping(const ScanJob& job) {
  MapScan scan;
  scan.scan = stages::scan_for_map(job.result, job.motion, job.anchor.epoch);
  scan.scan.after_gap = gap_to_mapping_;
  scan.points = rings_.points_pool.acquire();
  if (scan.points) {
    scan.points->assign(job.scan.deskewed.map_points_imu.view());
  } else {
    ++counts_.clouds_unmapped;
  }
  gap_to_mapping_ = !rings_.to_mapping.try_push(std::move(scan));
  if (gap_to_mapping_) {
    ++counts_.scans_unmapped;
    if (scan.points) {
      rings_.points_pool.put_back(std::move(scan.points));
    }
    return;
  }
  rings_.wake_mapping.notify();
}

void PublishLoop::take_imu(const ImuArrival& arrival) {
  const auto pose = stage_.add_imu(arrival.sample);
  if (!pose) {
    return;
  }
  send(*pose);
  const Stamp now = clock_.now();
  pose_monitor_.add(now - arrival.received, now);
}

void PublishLoop::send(const stages::PredictedPose& pose) {
  bus::Pose message;
  message.stamp = pose.stamp;
  message.age = clock_.now() - pose.stamp;
  message.T_odom_base = pose.T_odom_base;
  message.v_odom_base = pose.v_odom_base;
  message.rate_base_radps = pose.rate_base_radps;
  message.P_odom_base = pose.P_odom_base;
  message.P_velocity_odom = pose.P_velocity_odom;
  message.reset_counter = pose.reset_counter;
  message.correction_id = correction_id_;
  message.state = static_cast<bus::State>(pose.state);
  message.cause = static_cast<bus::Cause>(pose.cause);
  message.weak_axes = pose.weak_axes;
  if (counts_.epoch != rings_.epoch_wanted.load(std::memory_order_relaxed)) {
    message.state = bus::State::kStarting;  // this odom is about to end
    message.cause = bus::Cause::kAligning;
  }
  publisher_.publish(message);
  if (pose.reset_counter != counts_.reset_counter) {
    events_.write(pose.stamp, Event::kPoseReset, pose.reset_counter);
  }
  ++counts_.poses;
  counts_.reset_counter = pose.reset_counter;
  counts_.last_pose = pose.stamp;
  const Eigen::Vector3d& p = pose.T_odom_base.translation();
  counts_.x_m = p.x();
  counts_.y_m = p.y();
  counts_.z_m = p.z();
  counts_.yaw_rad = geometry::rpy_from_rotation(pose.T_odom_base.rotation()).z();
}

void PublishLoop::send_placement(Stamp now) {
  const std::uint64_t placement_version = rings_.placement.version();
  const std::uint64_t correction_version = rings_.correction.version();
  const bool placed = placement_version != placement_version_;
  const bool corrected = correction_version != correction_version_;
  const bool begun = placement_epoch_ != counts_.epoch;
  if (!placed && !corrected && !begun && now - last_placement_sent_ < kPlacementPeriod) {
    return;
  }
  placement_version_ = placement_version;
  correction_version_ = correction_version;
  placement_epoch_ = counts_.epoch;
  last_placement_sent_ = now;
  const MapPlacement placement = rings_.placement.load().value_or(MapPlacement{});
  const MapCorrection correction = rings_.correction.load().value_or(MapCorrection{});
  cause_ = corrected ? bus::Correction::kLoop : placed ? placement.cause : cause_;
  correction_id_ = placement.correction_id + correction.correction_id;
  bus::MapToOdom message;
  message.stamp = now;
  message.T_map_odom = placement.T_map_corrected() * correction.T_corrected_odom(counts_.epoch);
  message.correction_id = correction_id_;
  message.cause = cause_;
  publisher_.publish(message);
}

}  // namespace slamd::pipeline
