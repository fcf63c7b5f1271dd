#include "daemon/stages/mapping_stage.hpp"

#include "core/base/units.hpp"

namespace slamd::stages {

mapping::MapperConfig mapper_config(const configuration::Configuration& configuration) {
  const configuration::MappingConfiguration& wanted = configuration.mapping;
  mapping::MapperConfig config;
  config.keyframes = static_cast<std::size_t>(wanted.keyframes);
  config.loops = static_cast<std::size_t>(wanted.loops);
  config.points_a_cloud = static_cast<std::size_t>(wanted.cloud_points);
  config.novelty.spacing_indoor_m = wanted.spacing_indoor_m;
  config.novelty.spacing_outdoor_m = wanted.spacing_outdoor_m;
  config.use_loop_net = wanted.loop_net;
  config.use_gravity = configuration.imu.enabled;
  config.proximity.view_rad = wanted.view_deg * kDegree;
  return config;
}

ScanForMap scan_for_map(const odometry::OdometryResult& result, const odometry::MotionStep& motion, std::uint32_t epoch) {
  ScanForMap scan;
  scan.stamp = result.stamp;
  scan.epoch = epoch;
  scan.indoor = result.indoor;
  scan.trusted = result.map_updated;
  scan.T_odom_base = result.T_odom_base;
  scan.T_odom_imu = result.T_odom_imu;
  scan.up_odom = result.up_odom;
  scan.up_std_rad = result.up_std_rad;
  scan.motion = motion;
  return scan;
}

mapping::MapperUpdate MappingStage::process(const ScanForMap& scan, std::span<const Eigen::Vector3f> points_imu) {
  if (scan.epoch != epoch_) {
    epoch_ = scan.epoch;
    mapper_.restart();
  }
  mapping::MappedScan mapped = scan;
  mapped.points_imu = points_imu;
  return mapper_.process(mapped);
}

}  // namespace slamd::stages
