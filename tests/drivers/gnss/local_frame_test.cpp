#include "drivers/gnss/local_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamd::gnss {
namespace {

sensor::GnssFix fix_at(double latitude_deg, double longitude_deg, std::optional<double> altitude_m) {
  sensor::GnssFix fix;
  fix.quality = sensor::FixQuality::kSingle;
  fix.latitude_deg = latitude_deg;
  fix.longitude_deg = longitude_deg;
  fix.altitude_m = altitude_m;
  return fix;
}

TEST(LocalFrame, TakesTheFirstGoodFixForItsOrigin) {
  LocalFrame sut;
  sensor::GnssFix bad = fix_at(10.0, 10.0, 0.0);
  bad.quality = sensor::FixQuality::kNone;

  EXPECT_FALSE(sut.enu_of(bad));
  EXPECT_FALSE(sut.enu_of(fix_at(11.0, 11.0, std::nullopt)));  // how high?
  EXPECT_FALSE(sut.origin());
  const auto origin = sut.enu_of(fix_at(52.4, 13.5166, 34.0));

  ASSERT_TRUE(origin && sut.origin());
  EXPECT_EQ(origin->norm(), 0.0);
  EXPECT_EQ(sut.origin()->latitude_deg, 52.4);
}

TEST(LocalFrame, HasEastNorthAndUpInMetres) {
  LocalFrame sut;
  sut.enu_of(fix_at(0.0, 0.0, 0.0));
  // On the equator: the radius a to the east, a (1 − e²) to the north.
  const double small_deg = 1e-4;
  const double small_rad = small_deg * M_PI / 180.0;

  const auto east = sut.enu_of(fix_at(0.0, small_deg, 0.0));
  const auto north = sut.enu_of(fix_at(small_deg, 0.0, 0.0));
  const auto up = sut.enu_of(fix_at(0.0, 0.0, 100.0));

  EXPECT_NEAR(east->x(), 6378137.0 * small_rad, 1e-5);
  EXPECT_NEAR(east->y(), 0.0, 1e-9);
  EXPECT_NEAR(north->y(), 6378137.0 * (1.0 - 0.00669437999014) * small_rad, 1e-5);
  EXPECT_NEAR((*up - Eigen::Vector3d(0.0, 0.0, 100.0)).norm(), 0.0, 1e-9);
}

TEST(LocalFrame, PutsAFixWithoutAltitudeAtTheHeightOfTheOrigin) {
  LocalFrame sut;
  sut.enu_of(fix_at(52.4, 13.5166, 34.0));

  EXPECT_EQ(*sut.enu_of(fix_at(52.401, 13.52, std::nullopt)), *sut.enu_of(fix_at(52.401, 13.52, 34.0)));
}

TEST(LocalFrame, LeadsBack) {
  LocalFrame sut;
  sut.enu_of(fix_at(-45.8776, 170.5001, 12.0));
  for (const double step_m : {-5000.0, -1.0, 0.0, 3.0, 20'000.0}) {
    const Eigen::Vector3d p_enu(step_m, 2.0 * step_m, 0.01 * step_m);

    const LocalFrame::Geodetic place = sut.geodetic_of(p_enu);
    const auto again = sut.enu_of(fix_at(place.latitude_deg, place.longitude_deg, place.altitude_m));

    EXPECT_LT((*again - p_enu).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace slamd::gnss
