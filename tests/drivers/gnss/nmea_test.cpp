#include "drivers/gnss/nmea.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <chrono>
#include <cmath>
#include <random>
#include <string>

#include "receiver_bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::gnss {
namespace {

using namespace std::chrono_literals;

std::optional<Rmc> rmc_of(const std::string& body) { return parse_rmc(framed(body)); }

TEST(Nmea, ReadsTheTextbookRmc) {
  const auto rmc = parse_rmc(kRmcTextbook);

  ASSERT_TRUE(rmc && rmc->place && rmc->utc);
  EXPECT_TRUE(rmc->valid);
  EXPECT_EQ(rmc->utc->time_since_epoch(), 764'426'119s);  // 1994-03-23 12:35:19
  EXPECT_EQ(rmc->time_of_day, 12h + 35min + 19s);
  EXPECT_NEAR(rmc->place->latitude_deg, 48.0 + 7.038 / 60.0, 1e-9);
  EXPECT_NEAR(rmc->place->longitude_deg, 11.0 + 31.0 / 60.0, 1e-9);
  EXPECT_NEAR(*rmc->speed_mps, 11.5236, 1e-4);
  EXPECT_NEAR(*rmc->course_deg, 84.4, 1e-9);
}

TEST(Nmea, ReadsTheGoldenSentencesOfReceivers) {
  const auto rtk = parse_rmc(kRmcRtk);
  const auto empty_course = parse_rmc(kRmcEmptyCourse);

  ASSERT_TRUE(rtk && rtk->place && empty_course && empty_course->place);
  EXPECT_NEAR(rtk->place->latitude_deg, 40.336233623, 1e-9);
  EXPECT_NEAR(rtk->place->longitude_deg, 116.627415409, 1e-9);
  EXPECT_NEAR(*rtk->speed_mps, 8.342231, 1e-5);
  EXPECT_EQ(rtk->mode, 'D');
  EXPECT_EQ(rtk->utc->time_since_epoch(), 1'669'893'925'400ms);
  EXPECT_NEAR(empty_course->place->latitude_deg, 45.495404667, 1e-9);
  EXPECT_NEAR(empty_course->place->longitude_deg, -73.664347, 1e-9);
  EXPECT_FALSE(empty_course->course_deg);
}

TEST(Nmea, ReadsTheGoldenGgas) {
  const auto textbook = parse_gga(kGgaTextbook);
  const auto rtk = parse_gga(kGgaRtk);

  ASSERT_TRUE(textbook && textbook->place && rtk);
  EXPECT_NEAR(textbook->place->latitude_deg, 48.1173, 1e-9);
  EXPECT_EQ(textbook->quality, 1);
  EXPECT_EQ(textbook->satellites, 8);
  EXPECT_DOUBLE_EQ(*textbook->altitude_m, 545.4);
  EXPECT_DOUBLE_EQ(*textbook->altitude_m + *textbook->separation_m, 592.3);
  EXPECT_EQ(rtk->quality, 4);
  EXPECT_NEAR(*rtk->altitude_m + *rtk->separation_m, 48.9596, 1e-9);
  EXPECT_DOUBLE_EQ(*rtk->hdop, 0.9);
}

TEST(Nmea, ReadsGst) {
  const auto gst = parse_gst(framed("GNGST,231408.00,32,0.19,0.12,97,0.049,0.078,0.088"));

  ASSERT_TRUE(gst);
  EXPECT_EQ(gst->time_of_day, 23h + 14min + 8s);
  EXPECT_DOUBLE_EQ(*gst->latitude_std_m, 0.049);
  EXPECT_DOUBLE_EQ(*gst->longitude_std_m, 0.078);
  EXPECT_DOUBLE_EQ(*gst->altitude_std_m, 0.088);
}

TEST(Nmea, WritesTheGoldenSentencesByteForByteFromTheirBodies) {
  for (const std::string_view sentence : {kGgaTextbook, kRmcTextbook, kRmcRtk, kGgaRtk, kRmcEmptyCourse}) {
    EXPECT_EQ(framed(sentence.substr(1, sentence.rfind('*') - 1)), std::string(sentence) + "\r\n");
  }
}

TEST(Nmea, WritesWhatReadsBackToTheSame) {
  for (const std::string_view sentence : {kRmcTextbook, kRmcRtk, kRmcEmptyCourse}) {
    const auto rmc = parse_rmc(sentence);
    const auto again = parse_rmc(write_rmc(*rmc));

    ASSERT_TRUE(again) << write_rmc(*rmc);
    EXPECT_EQ(again->utc, rmc->utc);
    EXPECT_EQ(again->valid, rmc->valid);
    EXPECT_EQ(again->mode, rmc->mode);
    EXPECT_NEAR(again->place->latitude_deg, rmc->place->latitude_deg, 2e-9);
    EXPECT_NEAR(again->place->longitude_deg, rmc->place->longitude_deg, 2e-9);
    EXPECT_NEAR(*again->speed_mps, *rmc->speed_mps, 1e-4);
    EXPECT_EQ(again->course_deg, rmc->course_deg);
  }
  for (const std::string_view sentence : {kGgaTextbook, kGgaRtk}) {
    const auto gga = parse_gga(sentence);
    const auto again = parse_gga(write_gga(*gga));

    ASSERT_TRUE(again) << write_gga(*gga);
    EXPECT_EQ(again->time_of_day, gga->time_of_day);
    EXPECT_EQ(again->quality, gga->quality);
    EXPECT_EQ(again->satellites, gga->satellites);
    EXPECT_NEAR(*again->altitude_m, *gga->altitude_m, 1e-3);
    EXPECT_NEAR(*again->separation_m, *gga->separation_m, 1e-3);
  }
}

TEST(Nmea, WritesAnEmptySentenceAndALeapSecond) {
  const auto empty = parse_rmc(write_rmc({}));
  const auto leap = rmc_of("GPRMC,235960,V,,,,,,,311216,,");
  const auto again = parse_rmc(write_rmc(*leap));

  ASSERT_TRUE(empty && leap && again);
  EXPECT_FALSE(empty->time_of_day || empty->utc || empty->place || empty->valid);
  EXPECT_EQ(leap->utc->time_since_epoch(), 1'483'228'800s);  // the leap second ends the day
  EXPECT_EQ(again->utc, leap->utc);
}

TEST(Nmea, TakesAnyTalkerButNoMaker) {
  for (const char* talker : {"GP", "GL", "GA", "GB", "BD", "GQ", "GN"}) {
    EXPECT_EQ(sentence_type("$" + std::string(talker) + "RMC,1"), "RMC");
  }
  EXPECT_EQ(sentence_type("$PUBXRM,1"), "");
  EXPECT_EQ(sentence_type("$GPRM"), "");
  EXPECT_EQ(sentence_type(""), "");
}

TEST(Nmea, PutsSouthAndWestBelowZero) {
  const auto rmc = rmc_of("GNRMC,000000.00,A,3345.5000,S,07030.0000,W,0.0,,010126,,,A");

  ASSERT_TRUE(rmc && rmc->place);
  EXPECT_NEAR(rmc->place->latitude_deg, -(33.0 + 45.5 / 60.0), 1e-9);
  EXPECT_NEAR(rmc->place->longitude_deg, -70.5, 1e-9);
  EXPECT_EQ(rmc->utc->time_since_epoch(), 1'767'225'600s);
}

TEST(Nmea, TakesYearsFromEightyOnForTheLastCentury) {
  EXPECT_EQ(rmc_of("GPRMC,000000,V,,,,,,,010179,,")->utc->time_since_epoch(), 3'439'756'800s);  // 2079
  EXPECT_EQ(rmc_of("GPRMC,000000,V,,,,,,,010180,,")->utc->time_since_epoch(), 315'532'800s);    // 1980
}

TEST(Nmea, KeepsWhatAReceiverWithoutAFixKnows) {
  const auto nothing = rmc_of("GNRMC,,V,,,,,,,,,,N");
  const auto time = rmc_of("GNRMC,101112.00,V,,,,,,,,,,N");

  ASSERT_TRUE(nothing && time);
  EXPECT_FALSE(nothing->time_of_day || nothing->valid);
  EXPECT_EQ(time->time_of_day, 10h + 11min + 12s);
  EXPECT_FALSE(time->utc);
}

TEST(Nmea, RefusesWhatIsNoRmc) {
  for (const char* body : {"GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,",
                           "GPRMC",
                           "GPRMC,123519,A,4807.038,N",
                           "GPRMC,243519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,126019,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,123561,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,1235,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,123519x,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W",
                           "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,310294,003.1,W",
                           "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,231394,003.1,W",
                           "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,000094,003.1,W",
                           "GPRMC,123519,A,4807.038,N,01131.000,E,-2.4,084.4,230394,003.1,W",
                           "GPRMC,123519,A,4807.038,N,01131.000,E,022.4,484.4,230394,003.1,W",
                           "GPRMC,1x3519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W"}) {
    EXPECT_FALSE(rmc_of(body)) << body;
  }
  EXPECT_FALSE(parse_rmc(""));
  EXPECT_FALSE(parse_rmc("$"));
  EXPECT_FALSE(parse_rmc("*00"));
}

TEST(Nmea, RefusesAPlaceThatCannotBe) {
  for (const char* place : {"9100.000,N,01131.000,E", "4807.038,N,18100.000,E", "1e300,N,01131.000,E", "inf,N,nan,E",
                            "-4807.038,N,01131.000,E", "9000.001,N,01131.000,E", ",N,01131.000,E", "4807,N,x,E",
                            "4860.000,N,01131.000,E", "4807.038,,01131.000,E", "4807.038,N,01131.000,N"}) {
    EXPECT_FALSE(rmc_of("GPRMC,123519,A," + std::string(place) + ",022.4,084.4,230394,003.1,W")) << place;
    EXPECT_FALSE(parse_gga(framed("GPGGA,123519," + std::string(place) + ",1,08,0.9,545.4,M,46.9,M,,"))) << place;
  }
}

TEST(Nmea, ChecksTheChecksumWhateverItsCase) {
  EXPECT_TRUE(nmea_checksum_holds(kRmcTextbook));
  EXPECT_TRUE(nmea_checksum_holds("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6a"));
  EXPECT_FALSE(nmea_checksum_holds("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6B"));
  EXPECT_FALSE(nmea_checksum_holds("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6"));
  EXPECT_FALSE(nmea_checksum_holds("GPRMC,123519*00"));
  EXPECT_FALSE(nmea_checksum_holds(""));
}

TEST(Nmea, SurvivesAnyMutation) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const std::string_view original = seed % 2 == 0 ? kRmcTextbook : kGgaRtk;
    std::string body(original.substr(1, original.rfind('*') - 1));
    for (std::size_t i = random() % 6; i > 0; --i) {
      body[6 + random() % (body.size() - 6)] = "0123456789.,-eEnNiIfFaASW"[random() % 25];
    }

    const auto rmc = rmc_of(body);
    const auto gga = parse_gga(framed(body));

    // RC_ASSERT takes its expression apart: || would look at both sides.
    for (const auto& place : {rmc ? rmc->place : std::nullopt, gga ? gga->place : std::nullopt}) {
      const Place found = place.value_or(Place{});
      RC_ASSERT(std::abs(found.latitude_deg) <= 90.0);
      RC_ASSERT(std::abs(found.longitude_deg) <= 180.0);
    }
    RC_ASSERT(std::isfinite(rmc ? rmc->speed_mps.value_or(0.0) : 0.0));
    RC_ASSERT(std::isfinite(gga ? gga->altitude_m.value_or(0.0) : 0.0));
  }));
}

TEST(Nmea, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();

  const std::size_t count = support::count_allocations([] {
    parse_rmc(kRmcRtk);
    parse_gga(kGgaRtk);
  });

  EXPECT_EQ(count, 0U);
}

}  // namespace
}  // namespace slamd::gnss
