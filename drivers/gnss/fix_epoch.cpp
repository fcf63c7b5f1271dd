#include "drivers/gnss/fix_epoch.hpp"

#include <cmath>
#include <utility>

namespace slamd::gnss {

using sensor::FixQuality;
using sensor::GnssFix;
using Judged = std::pair<FixVerdict, FixQuality>;

namespace {

Judged refused(FixVerdict verdict) { return {verdict, FixQuality::kNone}; }

/// The quality of GGA.
Judged judge(int quality) {
  switch (quality) {
    case 0: return refused(FixVerdict::kNoFix);
    case 1: return {FixVerdict::kGood, FixQuality::kSingle};
    case 2: return {FixVerdict::kGood, FixQuality::kDifferential};
    case 3: return {FixVerdict::kGood, FixQuality::kSingle};  // the precise positioning service
    case 4: return {FixVerdict::kGood, FixQuality::kRtkFixed};
    case 5: return {FixVerdict::kGood, FixQuality::kRtkFloat};
    case 6: return refused(FixVerdict::kDeadReckoning);
    default: return refused(FixVerdict::kNotSatellites);
  }
}

Judged judge(const Rmc& rmc) {
  if (!rmc.valid) {
    return refused(FixVerdict::kNoFix);
  }
  switch (rmc.mode) {
    case 'A':
    case 'P': return judge(1);
    case 'D': return judge(2);
    case 'R': return judge(4);
    case 'F': return judge(5);
    case 'E': return judge(6);
    case 'N': return judge(0);
    default: return judge(8);
  }
}

Judged judge(const NavPvt& pvt) {
  switch (static_cast<UbxFixType>(pvt.fix_type)) {
    case UbxFixType::kNone: return refused(FixVerdict::kNoFix);
    case UbxFixType::kDeadReckoning: return refused(FixVerdict::kDeadReckoning);
    case UbxFixType::k2d: return refused(FixVerdict::kNoHeight);
    case UbxFixType::k3d:
    case UbxFixType::kWithDeadReckoning: break;
    case UbxFixType::kTimeOnly: return refused(FixVerdict::kTimeOnly);
    default: return refused(FixVerdict::kNotSatellites);
  }
  if ((pvt.flags & 1U) == 0 || (pvt.tail[0] & std::byte{1}) != std::byte{0}) {
    return refused(FixVerdict::kNotHeld);
  }
  if (!pvt.utc()) {
    return refused(FixVerdict::kNoTime);
  }
  switch (pvt.flags >> 6) {
    case 1: return judge(5);
    case 2: return judge(4);
    default: return judge((pvt.flags & 2U) != 0 ? 2 : 1);
  }
}

double course_of(const NavPvt& pvt) {
  const double course_deg = std::fmod(1e-5 * pvt.heading_of_motion_1e5deg, 360.0);
  return course_deg < 0.0 ? course_deg + 360.0 : course_deg;
}

void put(const Rmc& rmc, GnssFix& fix) {
  fix.utc = rmc.utc;
  fix.speed_mps = rmc.speed_mps;
  fix.course_deg = rmc.course_deg;
  if (rmc.place) {
    fix.latitude_deg = rmc.place->latitude_deg;
    fix.longitude_deg = rmc.place->longitude_deg;
  }
}

void put(const Gga& gga, GnssFix& fix) {
  fix.satellites = gga.satellites;
  fix.hdop = gga.hdop;
  if (gga.place) {
    fix.latitude_deg = gga.place->latitude_deg;
    fix.longitude_deg = gga.place->longitude_deg;
  }
  if (gga.altitude_m && gga.separation_m) {
    fix.altitude_m = *gga.altitude_m + *gga.separation_m;
  }
}

void put(const Gst& gst, GnssFix& fix) {
  if (gst.latitude_std_m && gst.longitude_std_m) {
    fix.horizontal_std_m = std::hypot(*gst.latitude_std_m, *gst.longitude_std_m);
  }
  fix.vertical_std_m = gst.altitude_std_m;
}

void put(const NavPvt& pvt, GnssFix& fix) {
  fix.utc = pvt.utc();
  fix.latitude_deg = 1e-7 * pvt.latitude_1e7deg;
  fix.longitude_deg = 1e-7 * pvt.longitude_1e7deg;
  fix.altitude_m = 1e-3 * pvt.height_mm;
  fix.satellites = pvt.satellites;
  fix.horizontal_std_m = 1e-3 * pvt.horizontal_accuracy_mm;
  fix.vertical_std_m = 1e-3 * pvt.vertical_accuracy_mm;
  fix.speed_mps = 1e-3 * pvt.ground_speed_mmps;
  fix.course_deg = course_of(pvt);
}

}  // namespace

const char* name_of(FixVerdict verdict) {
  switch (verdict) {
    case FixVerdict::kGood: return "good";
    case FixVerdict::kNoFix: return "no_fix";
    case FixVerdict::kTimeOnly: return "time_only";
    case FixVerdict::kNoHeight: return "no_height";
    case FixVerdict::kDeadReckoning: return "dead_reckoning";
    case FixVerdict::kNotSatellites: return "not_satellites";
    case FixVerdict::kNotHeld: return "not_held";
    case FixVerdict::kNoTime: return "no_time";
    case FixVerdict::kOutOfRange: return "out_of_range";
    case FixVerdict::kInaccurate: return "inaccurate";
  }
  return "?";
}

FixVerdict FixEpoch::merge(GnssFix& fix) const {
  Judged judged = refused(FixVerdict::kNoFix);
  if (rmc) {
    put(*rmc, fix);
    judged = judge(*rmc);
  }
  if (gga) {
    put(*gga, fix);
    // Each of them can say that there is no fix.
    judged = rmc && !rmc->valid ? judged : judge(gga->place ? gga->quality : 0);
  }
  if (gst) {
    put(*gst, fix);
  }
  if (pvt) {
    put(*pvt, fix);
    judged = judge(*pvt);
  }
  auto& [verdict, quality] = judged;
  if (verdict == FixVerdict::kGood && (std::abs(fix.latitude_deg) > 90.0 || std::abs(fix.longitude_deg) > 180.0)) {
    judged = refused(FixVerdict::kOutOfRange);
  } else if (verdict == FixVerdict::kGood && fix.horizontal_std_m.value_or(0.0) > kWorstStd_m) {
    judged = refused(FixVerdict::kInaccurate);
  }
  fix.quality = quality;
  return verdict;
}

}  // namespace slamd::gnss
