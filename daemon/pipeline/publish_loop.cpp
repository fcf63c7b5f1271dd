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
                         Rings& rings, bus::Publisher& publisher)
    : config_(config), clock_(clock), rings_(rings), publisher_(publisher), stage_(config, scan_period) {
  placement_.store(MapPlacement{});
}

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
  const bool changed = placement_.version() != placement_version_;
  if (!changed && now - last_placement_sent_ < kPlacementPeriod) {
    return;
  }
  placement_version_ = placement_.version();
  last_placement_sent_ = now;
  const MapPlacement placement = *placement_.load();
  correction_id_ = placement.correction_id;
  bus::MapToOdom message;
  message.stamp = now;
  message.T_map_odom = Se3(geometry::rotation_from_rpy({0.0, 0.0, placement.yaw_rad}),
                           Eigen::Vector3d(placement.x_m, placement.y_m, placement.z_m));
  message.correction_id = placement.correction_id;
  message.cause = placement.cause;
  publisher_.publish(message);
}

}  // namespace slamd::pipeline
