#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/simulate/noise.hpp"

namespace slamd::loopnet {

/// What a LiDAR of one world's vehicle sees from a pose: directions of its rays, in lidar.
class PlaceSensor {
 public:
  enum class Kind : std::uint8_t { kVlp16, kAvia, kHdl64, kSpinning };

  /// Spinning LiDARs of any kind have lines and a field of view by `noise`.
  PlaceSensor(Kind kind, const simulate::Noise& noise);

  Kind kind() const { return kind_; }

  /// Fills `rays` with about `count` unit vectors; another `draw`, other ones.
  void look(std::size_t count, std::uint64_t draw, std::vector<Eigen::Vector3d>& rays) const;

  /// How high the LiDAR sits above the floor at least and at most.
  Eigen::Vector2d heights_m() const;

 private:
  Kind kind_;
  simulate::Noise noise_;
  std::vector<double> elevations_rad_;  // of a spinning LiDAR's lines
};

/// Names for command lines: vlp16, avia, hdl64, spinning. Errors: std::invalid_argument.
PlaceSensor::Kind sensor_kind(const std::string& name);

}  // namespace slamd::loopnet
