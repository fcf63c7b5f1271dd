#include "tools/replay/emulated_gnss.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"
#include "drivers/gnss/nmea.hpp"
#include "drivers/gnss/ubx.hpp"

namespace slamd::replay {

using sensor::FixQuality;
using sensor::GnssFix;

namespace {

constexpr double kErrorOfDop_m = 3.0;  // of a receiver that says no other

double horizontal_std_m(const GnssFix& fix) { return fix.horizontal_std_m.value_or(kErrorOfDop_m * fix.hdop.value_or(1.0)); }
double vertical_std_m(const GnssFix& fix) { return fix.vertical_std_m.value_or(1.8 * horizontal_std_m(fix)); }

std::string sentences_of(const GnssFix& fix) {
  const auto second = std::chrono::round<std::chrono::milliseconds>(*fix.utc);
  const Duration time_of_day = second - std::chrono::floor<std::chrono::days>(second);
  gnss::Rmc rmc;
  gnss::Gga gga;
  gnss::Gst gst;
  rmc.time_of_day = gga.time_of_day = gst.time_of_day = time_of_day;
  rmc.utc = second;
  rmc.mode = fix.is_good() ? 'A' : 'N';
  gga.quality = static_cast<int>(fix.quality);
  gga.satellites = fix.satellites;
  gga.hdop = fix.hdop;
  if (fix.is_good()) {
    rmc.valid = true;
    rmc.place = gga.place = gnss::Place{fix.latitude_deg, fix.longitude_deg};
    rmc.speed_mps = fix.speed_mps;
    rmc.course_deg = fix.course_deg;
    gga.altitude_m = fix.altitude_m;
    gga.separation_m = 0.0;  // its geoid is the ellipsoid
    gst.latitude_std_m = gst.longitude_std_m = horizontal_std_m(fix) / std::sqrt(2.0);
    gst.altitude_std_m = vertical_std_m(fix);
  }
  return write_rmc(rmc) + write_gga(gga) + write_gst(gst);
}

std::uint8_t flags_of(FixQuality quality) {
  switch (quality) {
    case FixQuality::kNone: return 0;
    case FixQuality::kSingle: return 0x01;
    case FixQuality::kDifferential: return 0x03;
    case FixQuality::kRtkFloat: return 0x43;
    case FixQuality::kRtkFixed: return 0x83;
  }
  return 0;
}

std::int32_t scaled(double value, double per_unit) { return static_cast<std::int32_t>(std::lround(value * per_unit)); }

gnss::NavPvt pvt_of(const GnssFix& fix) {
  const auto second = std::chrono::floor<std::chrono::seconds>(*fix.utc);
  const auto day = std::chrono::floor<std::chrono::days>(second);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss time{second - day};
  gnss::NavPvt pvt;
  pvt.year = static_cast<std::uint16_t>(static_cast<int>(date.year()));
  pvt.month = static_cast<std::uint8_t>(static_cast<unsigned>(date.month()));
  pvt.day = static_cast<std::uint8_t>(static_cast<unsigned>(date.day()));
  pvt.hour = static_cast<std::uint8_t>(time.hours().count());
  pvt.minute = static_cast<std::uint8_t>(time.minutes().count());
  pvt.second = static_cast<std::uint8_t>(time.seconds().count());
  pvt.nano_ns = static_cast<std::int32_t>((*fix.utc - second).count());
  pvt.valid = 0x07;
  pvt.fix_type = fix.is_good() ? 3 : 0;
  pvt.flags = flags_of(fix.quality);
  pvt.satellites = fix.satellites;
  pvt.longitude_1e7deg = scaled(fix.longitude_deg, 1e7);
  pvt.latitude_1e7deg = scaled(fix.latitude_deg, 1e7);
  pvt.height_mm = pvt.height_msl_mm = scaled(fix.altitude_m.value_or(0.0), 1e3);
  pvt.horizontal_accuracy_mm = static_cast<std::uint32_t>(scaled(horizontal_std_m(fix), 1e3));
  pvt.vertical_accuracy_mm = static_cast<std::uint32_t>(scaled(vertical_std_m(fix), 1e3));
  const double course_rad = fix.course_deg.value_or(0.0) * M_PI / 180.0;
  pvt.ground_speed_mmps = scaled(fix.speed_mps.value_or(0.0), 1e3);
  pvt.velocity_north_mmps = scaled(fix.speed_mps.value_or(0.0) * std::cos(course_rad), 1e3);
  pvt.velocity_east_mmps = scaled(fix.speed_mps.value_or(0.0) * std::sin(course_rad), 1e3);
  pvt.heading_of_motion_1e5deg = scaled(fix.course_deg.value_or(0.0), 1e5);
  return pvt;
}

}  // namespace

std::string message_of(const GnssFix& fix, GnssTalk talk) {
  SLAMD_ASSERT(fix.utc.has_value());
  std::string bytes = talk == GnssTalk::kUbx ? std::string() : sentences_of(fix);
  if (talk != GnssTalk::kNmea) {
    const auto payload = pvt_of(fix).bytes();
    const gnss::UbxBytes frame = gnss::write_ubx({gnss::ubx::kNav, gnss::ubx::kNavPvt, payload.view()});
    bytes.append(reinterpret_cast<const char*>(frame.data()), frame.size());
  }
  return bytes;
}

}  // namespace slamd::replay
