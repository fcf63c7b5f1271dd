#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace slamd::simulate {

/// The Avia's three-prism scanner: where each of its six lines looks at a time.
/// Source: livox-scan-pattern description, section 2 (wedges of HELIOS++, rates fitted to a real unit).
class Risley {
 public:
  /// `phases_rad` of the three prisms at time 0.
  explicit Risley(const std::array<double, 3>& phases_rad) : phases_rad_(phases_rad) {}

  /// Frames: unit vector in lidar (x forward, y left, z up).  Units: s.
  Eigen::Vector3d direction(double t_s, int line) const;

 private:
  std::array<double, 3> phases_rad_;
};

}  // namespace slamd::simulate
