#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/stamp.hpp"
#include "core/sensor/gnss_fix.hpp"

namespace slamd::gnss {

/// A place as sentences give it.  Units: degrees, north and east positive.
struct Place {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// Recommended minimum: the only sentence with a date. Any field may be empty, as it is before the first fix.
struct Rmc {
  std::optional<Duration> time_of_day;     // UTC; up to 24 h and 1 s in a leap second
  std::optional<sensor::UtcStamp> utc;     // with its date
  bool valid = false;                      // A, not V, and with a place
  std::optional<Place> place;
  std::optional<double> speed_mps;
  std::optional<double> course_deg;
  char mode = 'A';                         // A, D, E, N, R, F, P ...; A where an old receiver has none
};

/// Fix data.
struct Gga {
  std::optional<Duration> time_of_day;
  std::optional<Place> place;
  int quality = 0;                         // as the sentence counts: 0 none ... 8 simulated
  std::uint8_t satellites = 0;
  std::optional<double> hdop;
  std::optional<double> altitude_m;        // above mean sea level
  std::optional<double> separation_m;      // of the geoid: altitude above the ellipsoid = altitude + separation
};

/// Error statistics.  Units: m, 1σ.
struct Gst {
  std::optional<Duration> time_of_day;
  std::optional<double> latitude_std_m;
  std::optional<double> longitude_std_m;
  std::optional<double> altitude_std_m;
};

/// Tells whether "$...*hh" carries the XOR of what stands between $ and *; what follows the digits does not count.
bool nmea_checksum_holds(std::string_view sentence);

/// Returns the three letters of a sentence's type, whoever talks: "RMC"; empty for a proprietary or broken one.
std::string_view sentence_type(std::string_view sentence);

// These read a sentence "$...*hh", with or without its line end, of any talker; numbers with any decimals.
// Errors: nothing for another type, a wrong checksum, too few fields, or a field that cannot be: not a number, a place
// or a time that is none, a height beyond 100 km.  Real-time: no allocation.
// Source: gnss.md §3. Two digits of a year: 80 to 99 are of the last century.
std::optional<Rmc> parse_rmc(std::string_view sentence);
std::optional<Gga> parse_gga(std::string_view sentence);
std::optional<Gst> parse_gst(std::string_view sentence);

/// Frames what stands between $ and *: "$body*HH\r\n".
std::string framed(std::string_view body);

// These write a sentence of talker GN, which reads back to the same values within 1e-7 minutes, mm and ms.
std::string write_rmc(const Rmc& rmc);
std::string write_gga(const Gga& gga);
std::string write_gst(const Gst& gst);

}  // namespace slamd::gnss
