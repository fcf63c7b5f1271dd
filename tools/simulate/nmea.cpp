#include "tools/simulate/nmea.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>

namespace slamd::simulate {

namespace {

constexpr double kAxis_m = 6378137.0;
constexpr double kEccentricity2 = 0.00669437999014;
constexpr double kDegree = M_PI / 180.0;

Eigen::Vector3d earth_centred(double latitude, double longitude, double altitude) {
  const double n = kAxis_m / std::sqrt(1.0 - kEccentricity2 * std::sin(latitude) * std::sin(latitude));
  return {(n + altitude) * std::cos(latitude) * std::cos(longitude),
          (n + altitude) * std::cos(latitude) * std::sin(longitude),
          (n * (1.0 - kEccentricity2) + altitude) * std::sin(latitude)};
}

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
  const double lat0 = kOriginLatitude_deg * kDegree;
  const double lon0 = kOriginLongitude_deg * kDegree;
  Eigen::Matrix3d axes;  // east, north, up
  axes << -std::sin(lon0), -std::sin(lat0) * std::cos(lon0), std::cos(lat0) * std::cos(lon0), std::cos(lon0),
      -std::sin(lat0) * std::sin(lon0), std::cos(lat0) * std::sin(lon0), 0.0, std::cos(lat0), std::sin(lat0);
  const Eigen::Vector3d p = earth_centred(lat0, lon0, kOriginAltitude_m) + axes * p_world;
  const double flat = std::hypot(p.x(), p.y());
  double latitude = lat0;
  double altitude = 0.0;
  for (int i = 0; i < 8; ++i) {
    const double n = kAxis_m / std::sqrt(1.0 - kEccentricity2 * std::sin(latitude) * std::sin(latitude));
    altitude = flat / std::cos(latitude) - n;
    latitude = std::atan2(p.z(), flat * (1.0 - kEccentricity2 * n / (n + altitude)));
  }
  return {latitude / kDegree, std::atan2(p.y(), p.x()) / kDegree, altitude};
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
  unsigned sum = 0;
  for (const char* c = text; *c != '\0'; ++c) {
    sum ^= static_cast<unsigned char>(*c);
  }
  char sentence[176];
  std::snprintf(sentence, sizeof sentence, "$%s*%02X\r\n", text, sum);
  return sentence;
}

}  // namespace slamd::simulate
