#pragma once

#include <cstdint>
#include <span>

#include "core/mapping/mapper.hpp"
#include "core/odometry/odometry.hpp"
#include "daemon/configuration/configuration.hpp"

namespace slamd::stages {

/// Returns what the mapper is built from.
mapping::MapperConfig mapper_config(const configuration::Configuration& configuration);

/// What mapping takes of a scan, and of which odom it is; passes between threads by copy, without its points.
struct ScanForMap : mapping::MappedScan {
  std::uint32_t epoch = 1;
};

/// Takes out of a scan's result what mapping needs.
ScanForMap scan_for_map(const odometry::OdometryResult& result, const odometry::MotionStep& motion, std::uint32_t epoch);

/// The mapping stage: what the odometry has of each scan to a map that corrects itself.
/// Threads: one; not a real-time one.
class MappingStage {
 public:
  explicit MappingStage(const mapping::MapperConfig& config) : mapper_(config) {}

  /// Takes a scan in after the odometry. Another epoch than before is another odom: the map begins anew.
  /// Frames: points in imu at the scan's end; they may be left out.
  mapping::MapperUpdate process(const ScanForMap& scan, std::span<const Eigen::Vector3f> points_imu);

  /// Takes the last keyframe in: at the end of a recording.
  mapping::MapperUpdate finish() { return mapper_.finish(); }

  const mapping::Mapper& mapper() const { return mapper_; }
  std::uint32_t epoch() const { return epoch_; }

 private:
  mapping::Mapper mapper_;
  std::uint32_t epoch_ = 1;
};

}  // namespace slamd::stages
