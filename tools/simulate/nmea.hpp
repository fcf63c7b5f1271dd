#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

namespace slamd::simulate {

/// Where the simulated worlds lie on the Earth: x east, y north of this place.
inline constexpr double kOriginLatitude_deg = 52.4;
inline constexpr double kOriginLongitude_deg = 13.5166;
inline constexpr double kOriginAltitude_m = 34.0;

/// A place on the WGS-84 ellipsoid.
struct Geodetic {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;
};

/// Converts a place in world (east, north, up from the origin) exactly, over the Earth-centred frame.
Geodetic geodetic_of(const Eigen::Vector3d& p_world);

/// Writes a $GPRMC sentence with its checksum, CR and LF.
std::string rmc_sentence(std::int64_t unix_s, const Geodetic& place, double speed_mps, double course_deg);

}  // namespace slamd::simulate
