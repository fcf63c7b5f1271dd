#include "daemon/stages/odometry_stage.hpp"

namespace slamd::stages {

OdometryStage::OdometryStage(const odometry::OdometryConfig& config)
    : imu_(sensor::ImuBufferConfig{}), odometry_(config) {}

void OdometryStage::take(const PreprocessedScan& scan) {
  for (const sensor::ImuSample& sample : scan.imu) {
    imu_.push(sample);
  }
  if (scan.start) {
    odometry_.start(*scan.start);
  } else if (scan.start_without_imu) {
    odometry_.start_without_imu(*scan.start_without_imu);
  }
}

odometry::OdometryResult OdometryStage::process(const PreprocessedScan& scan) {
  take(scan);
  const auto samples = bracket(imu_.samples(), odometry_.state().stamp, scan.deskewed.end);
  const odometry::OdometryResult result = odometry_.process(scan.deskewed, samples, scan.wheels.view());
  imu_.drop_before(odometry_.state().stamp);
  sequence_ = scan.sequence;
  return result;
}

}  // namespace slamd::stages
