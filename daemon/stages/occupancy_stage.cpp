#include "daemon/stages/occupancy_stage.hpp"

#include <algorithm>

namespace slamd::stages {

occupancy::GridConfig grid_config(const configuration::Configuration& configuration) {
  const configuration::OccupancyConfiguration& wanted = configuration.occupancy;
  occupancy::GridConfig config;
  config.cell_m = wanted.fine_cells ? 0.1 : 0.2;
  config.box_m = wanted.box_m;
  config.height_m = wanted.height_m;
  config.max_points = configuration.odometry.preprocess.max_map_points;
  for (const scan::Box& box : configuration.odometry.preprocess.self_filter.boxes_base) {
    occupancy::BodyBox body;
    std::copy(box.min_m, box.min_m + 3, body.min_m);
    std::copy(box.max_m, box.max_m + 3, body.max_m);
    config.body.push_back(body);
  }
  return config;
}

ScanToCarve scan_to_carve(const odometry::OdometryResult& result, const scan::DeskewedScan& deskewed, std::uint32_t epoch,
                          const Eigen::Vector3d& p_base_lidar) {
  ScanToCarve scan;
  scan.stamp = result.stamp;
  scan.epoch = epoch;
  scan.map_restarts = result.map_restarts;
  scan.trusted = result.map_updated;
  scan.T_odom_base = result.T_odom_base;
  scan.T_odom_imu = result.T_odom_imu;
  scan.origin_odom = result.T_odom_base * p_base_lidar - 0.5 * to_seconds(deskewed.end - deskewed.begin) * result.v_odom_base;
  return scan;
}

OccupancyStage::OccupancyStage(const occupancy::GridConfig& grid, const occupancy::DeltaConfig& delta, Stamp now)
    : grid_(grid), source_(delta, grid_), map_id_(std::max<std::int64_t>(1, now.time_since_epoch().count())) {
  source_.restart(map_id_, epoch_);
}

void OccupancyStage::restart(const ScanToCarve& scan, Stamp now) {
  epoch_ = scan.epoch;
  map_restarts_ = scan.map_restarts;
  submap_ = -1;
  stamp_ = scan.stamp;
  map_id_ = std::max(map_id_ + 1, now.time_since_epoch().count());
  grid_.restart(scan.T_odom_base.translation());
  source_.restart(map_id_, epoch_);
}

void OccupancyStage::process(const ScanToCarve& scan, std::span<const Eigen::Vector3f> points_imu, const NewestSubmap& submap, Stamp now) {
  if (scan.epoch != epoch_ || scan.map_restarts != map_restarts_) {
    restart(scan, now);
  }
  if (submap.epoch == epoch_ && submap.id != submap_ && submap.id >= 0) {
    submap_ = submap.id;
    const Eigen::Vector3d anchor_odom = Eigen::Vector3d::Map(submap.anchor_odom_m);
    const double cell_m = grid_.states().cell_m();
    source_.set_anchor(submap_, occupancy::cell_of(anchor_odom + Eigen::Vector3d::Constant(0.5 * cell_m), cell_m).block());
    grid_.set_submap(submap_);
  }
  if (scan.trusted) {
    stamp_ = scan.stamp;
    grid_.insert({points_imu, scan.T_odom_imu, scan.T_odom_base, scan.origin_odom});
  }
}

}  // namespace slamd::stages
