#pragma once

#include <cstdint>

#include "core/geometry/se3.hpp"
#include "core/sensor/gnss_fix.hpp"
#include "tools/simulate/motion.hpp"
#include "tools/simulate/nmea.hpp"
#include "tools/simulate/noise.hpp"

namespace slamd::simulate {

/// How a receiver errs.
struct GnssErrors {
  double drift_m = 1.2;             // 1σ, slow: atmosphere and orbits
  double drift_s = 120.0;
  double noise_m = 0.3;             // 1σ, of each fix
  double multipath_chance = 0.05;   // per ten seconds: all fixes are off by the same
  double multipath_m = 12.0;        // at most
  double outage_chance = 0.04;      // per ten seconds: no fix
  bool covered = false;             // under a roof: never a fix
};

/// One row of gnss.csv.
struct GnssReading {
  int quality = 0;  // as in GGA: 0 none, 1 alone
  Geodetic place;
  int satellites = 0;
  double hdop = 99.9;
  double speed_mps = 0.0;
  double course_deg = 0.0;
};

inline constexpr double kGnss_hz = 5.0;

/// A reading as a driver would make it, but for its stamp.
sensor::GnssFix fix_of(const GnssReading& reading);

/// Says once in 1/rate seconds where the antenna is.
class GnssSensor {
 public:
  GnssSensor(const Motion& motion, const geometry::Se3& T_base_antenna, double rate_hz, const GnssErrors& errors,
             std::uint64_t seed);

  /// When the next reading is due.
  double next_s() const { return static_cast<double>(index_) / rate_hz_; }

  /// Returns false after the end of the drive.
  bool next(double& t_s, GnssReading& reading);

 private:
  const Motion& motion_;
  geometry::Se3 T_base_antenna_;
  double rate_hz_;
  GnssErrors errors_;
  Noise noise_;
  std::uint64_t index_ = 0;
  Eigen::Vector3d drift_;
};

}  // namespace slamd::simulate
