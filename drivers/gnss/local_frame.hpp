#pragma once

#include <optional>

#include <Eigen/Core>
#include <GeographicLib/LocalCartesian.hpp>

#include "core/sensor/gnss_fix.hpp"

namespace slamd::gnss {

/// The plane world around a place: the first good fix is its origin, x east, y north, z up.
/// Frames: positions of the antenna in enu.  Units: m; degrees and m above the WGS-84 ellipsoid.
/// Source: GeographicLib's LocalCartesian, exact over the Earth-centred frame.
/// Real-time: no allocation.
class LocalFrame {
 public:
  struct Geodetic {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double altitude_m = 0.0;
  };

  /// Returns where a fix lies; nothing for a fix that is not good. One without altitude lies at the origin's height, and
  /// is no origin itself.
  std::optional<Eigen::Vector3d> enu_of(const sensor::GnssFix& fix);

  /// The way back. Errors: the origin must be known.
  Geodetic geodetic_of(const Eigen::Vector3d& p_enu) const;

  const std::optional<Geodetic>& origin() const { return origin_; }

 private:
  std::optional<Geodetic> origin_;
  GeographicLib::LocalCartesian around_;
};

}  // namespace slamd::gnss
