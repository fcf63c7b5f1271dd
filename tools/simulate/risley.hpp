#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace slamd::simulate {

/// How the prisms turn: so that the pattern never comes back, or that it is the same band ten times a second.
enum class RisleyPattern { kNonRepetitive, kRepetitive };

/// The Avia's three-prism scanner: where each of its six lines looks at a time.
/// Source: livox-scan-pattern description, section 2 (wedges of HELIOS++, rates fitted to a real unit; those of the
/// repetitive pattern are inferred from its field of view, their common factor is a guess).
class Risley {
 public:
  /// `phases_rad` of the three prisms at time 0. In the repetitive pattern they decide which way the band lies: it is
  /// level where they are in the ratio of the rates, -1 : 1 : 3.
  explicit Risley(const std::array<double, 3>& phases_rad, RisleyPattern pattern = RisleyPattern::kNonRepetitive);

  /// Frames: unit vector in lidar (x forward, y left, z up).  Units: s.
  Eigen::Vector3d direction(double t_s, int line) const;

 private:
  std::array<double, 3> phases_rad_;
  std::array<double, 3> rates_hz_;
};

}  // namespace slamd::simulate
