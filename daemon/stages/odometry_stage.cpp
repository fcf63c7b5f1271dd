#include "daemon/stages/odometry_stage.hpp"

namespace slamd::stages {

namespace {

/// Ten seconds at 100 Hz.
constexpr std::size_t kMaxWheels = 1024;

}  // namespace

OdometryStage::OdometryStage(const odometry::OdometryConfig& config)
    : imu_(sensor::ImuBufferConfig{}), wheels_(kMaxWheels), odometry_(config) {}

void OdometryStage::take(const PreprocessedScan& scan) {
  for (const sensor::ImuSample& sample : scan.imu) {
    imu_.push(sample);
  }
  for (const sensor::WheelSample& sample : scan.wheels) {
    push_newest(wheels_, sample);
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
  const odometry::OdometryResult result = odometry_.process(scan.deskewed, samples, wheels_.view());
  note_done(scan);
  return result;
}

odometry::OdometryResult OdometryStage::go_on_without_scan(const PreprocessedScan& step) {
  take(step);
  const auto samples = bracket(imu_.samples(), odometry_.state().stamp, step.deskewed.end);
  const odometry::OdometryResult result = odometry_.go_on_without_scan(step.deskewed.end, samples, wheels_.view());
  note_done(step);
  return result;
}

void OdometryStage::note_done(const PreprocessedScan& scan) {
  wheels_.clear();
  imu_.drop_before(odometry_.state().stamp);
  sequence_ = scan.sequence;
}

}  // namespace slamd::stages
