#include "tools/simulate/gnss_sensor.hpp"

#include <cmath>

namespace slamd::simulate {

namespace {

const Eigen::Vector3d kMoreUpwards(1.0, 1.0, 1.8);  // heights are always worse

Eigen::Vector3d triple(const Noise& noise, std::uint64_t stream) {
  return Eigen::Vector3d(noise.normal(stream), noise.normal(stream + 1), noise.normal(stream + 2))
      .cwiseProduct(kMoreUpwards);
}

}  // namespace

sensor::GnssFix fix_of(const GnssReading& reading) {
  sensor::GnssFix fix;
  fix.quality = static_cast<sensor::FixQuality>(reading.quality);
  fix.latitude_deg = reading.place.latitude_deg;
  fix.longitude_deg = reading.place.longitude_deg;
  fix.altitude_m = reading.place.altitude_m;
  fix.satellites = static_cast<std::uint8_t>(reading.satellites);
  fix.hdop = reading.hdop;
  fix.speed_mps = reading.speed_mps;
  fix.course_deg = reading.course_deg;
  return fix;
}

GnssSensor::GnssSensor(const Motion& motion, const geometry::Se3& T_base_antenna, double rate_hz,
                       const GnssErrors& errors, std::uint64_t seed)
    : motion_(motion),
      T_base_antenna_(T_base_antenna),
      rate_hz_(rate_hz),
      errors_(errors),
      noise_(seed, 90),
      drift_(errors.drift_m * triple(noise_, 10)) {}

bool GnssSensor::next(double& t_s, GnssReading& reading) {
  t_s = static_cast<double>(index_) / rate_hz_;
  if (t_s > motion_.duration_s()) {
    return false;
  }
  const std::uint64_t stream = 1'000'000 + 16 * index_++;
  // A Gauss–Markov process of first order.
  const double keep = std::exp(-1.0 / (rate_hz_ * errors_.drift_s));
  drift_ = keep * drift_ + std::sqrt(1.0 - keep * keep) * errors_.drift_m * triple(noise_, stream);
  const auto ten_seconds = static_cast<std::uint64_t>(t_s / 10.0);
  reading = {};
  if (errors_.covered || noise_.uniform(1000 + ten_seconds) < errors_.outage_chance) {
    return true;
  }
  const MotionState state = motion_.at(t_s);
  Eigen::Vector3d p =
      state.T_world_base * T_base_antenna_.translation() + drift_ + errors_.noise_m * triple(noise_, stream + 4);
  const bool mirrored = noise_.uniform(100'000 + ten_seconds) < errors_.multipath_chance;
  if (mirrored) {
    const double heading = noise_.uniform(200'000 + ten_seconds, 0.0, 2.0 * M_PI);
    p += noise_.uniform(300'000 + ten_seconds, 0.3, 1.0) * errors_.multipath_m *
         Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.4);
  }
  const Eigen::Vector3d& v = state.velocity_mps;
  reading.quality = 1;
  reading.place = geodetic_of(p);
  reading.satellites = mirrored ? 6 : 11;
  reading.hdop = mirrored ? 2.4 : 0.9;
  reading.speed_mps = std::abs(v.head<2>().norm() + 0.05 * noise_.normal(stream + 8));
  reading.course_deg = std::fmod(std::atan2(v.x(), v.y()) * 180.0 / M_PI + 360.0, 360.0);
  return true;
}

}  // namespace slamd::simulate
