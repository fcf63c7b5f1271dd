#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/base/stamp.hpp"

namespace slamd::sensor {

/// How a position was found; counts as NMEA's GGA does. kNone also stands for a position that must not be used.
enum class FixQuality : std::uint8_t {
  kNone = 0,
  kSingle = 1,
  kDifferential = 2,
  kRtkFixed = 4,
  kRtkFloat = 5,
};

/// A time of the calendar, as receivers and people count it; no clock of this house.
using UtcStamp = std::chrono::sys_time<Duration>;

/// What a satellite receiver says of one moment.
/// Frames: the antenna on the WGS-84 ellipsoid; course clockwise from true north.
/// Units: degrees (here alone: what maps, files and receivers count in), m above the ellipsoid, m/s; accuracies are 1σ.
struct GnssFix {
  Stamp stamp{};                                  // on the time base
  std::optional<UtcStamp> utc;                    // of the fix, by the receiver
  FixQuality quality = FixQuality::kNone;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  std::optional<double> altitude_m;               // unknown to a receiver that sends RMC alone
  std::uint8_t satellites = 0;                    // used
  std::optional<double> hdop;
  std::optional<double> horizontal_std_m;
  std::optional<double> vertical_std_m;
  std::optional<double> speed_mps;
  std::optional<double> course_deg;               // 0 to 360

  bool is_good() const { return quality != FixQuality::kNone; }
};

}  // namespace slamd::sensor
