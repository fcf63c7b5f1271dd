#include "tools/simulate/nmea.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>

#include <GeographicLib/LocalCartesian.hpp>

#include "drivers/gnss/nmea.hpp"

namespace slamd::simulate {

namespace {

/// Degrees and minutes as NMEA writes them, and the hemisphere.
std::string degrees_minutes(double value_deg, int digits, char positive, char negative) {
  const double magnitude = std::abs(value_deg);
  // Rounded as a whole, so that no sentence says 60 minutes.
  const auto ten_thousandths = static_cast<long long>(std::llround(magnitude * 60.0 * 1e5));
  const long long degrees = ten_thousandths / 6'000'000;
  char text[48];
  std::snprintf(text, sizeof text, "%0*lld%08.5f,%c", digits, degrees,
                1e-5 * static_cast<double>(ten_thousandths % 6'000'000), value_deg < 0.0 ? negative : positive);
  return text;
}

}  // namespace

Geodetic geodetic_of(const Eigen::Vector3d& p_world) {
  static const GeographicLib::LocalCartesian kAround(kOriginLatitude_deg, kOriginLongitude_deg, kOriginAltitude_m);
  Geodetic place;
  kAround.Reverse(p_world.x(), p_world.y(), p_world.z(), place.latitude_deg, place.longitude_deg, place.altitude_m);
  return place;
}

std::string rmc_sentence(std::int64_t unix_s, const Geodetic& place, double speed_mps, double course_deg) {
  const std::time_t now = unix_s;
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[160];
  std::snprintf(text, sizeof text, "GPRMC,%02d%02d%02d,A,%s,%s,%05.1f,%05.1f,%02d%02d%02d,003.1,W", utc.tm_hour,
                utc.tm_min, utc.tm_sec, degrees_minutes(place.latitude_deg, 2, 'N', 'S').c_str(),
                degrees_minutes(place.longitude_deg, 3, 'E', 'W').c_str(), speed_mps / 0.514444, course_deg,
                utc.tm_mday, utc.tm_mon + 1, utc.tm_year % 100);
  return gnss::framed(text);
}

}  // namespace slamd::simulate
