#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "drivers/gnss/nmea.hpp"
#include "drivers/gnss/ubx.hpp"

namespace slamd::gnss {

/// What is to be thought of a fix; all but the first are refusals: the fix then has quality kNone.
enum class FixVerdict : std::uint8_t {
  kGood,
  kNoFix,          // the receiver has none
  kTimeOnly,       // a timing receiver's
  kNoHeight,       // of two dimensions only
  kDeadReckoning,  // without satellites
  kNotSatellites,  // entered by hand, or simulated, or of a kind that is not known
  kNotHeld,        // the receiver itself does not hold it for good (gnssFixOK, invalidLlh)
  kNoTime,         // NAV-PVT without a valid date and time
  kOutOfRange,     // a place that is none
  kInaccurate,     // by its own account worse than kWorstStd_m
};

inline constexpr std::size_t kFixVerdicts = 10;
inline constexpr double kWorstStd_m = 50.0;

/// Names a verdict as reports and health spell it.
const char* name_of(FixVerdict verdict);

/// What a receiver has said of one moment, in as many messages as it likes; NAV-PVT goes before sentences, GGA before RMC.
struct FixEpoch {
  std::optional<Rmc> rmc;
  std::optional<Gga> gga;
  std::optional<Gst> gst;
  std::optional<NavPvt> pvt;

  /// Merges them into one fix.  Units: as GnssFix; horizontal accuracy of GST is the root of both variances.
  FixVerdict merge(sensor::GnssFix& fix) const;
};

}  // namespace slamd::gnss
