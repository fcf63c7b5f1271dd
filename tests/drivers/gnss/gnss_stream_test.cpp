#include "drivers/gnss/gnss_stream.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <chrono>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include "receiver_bytes.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::gnss {
namespace {

using namespace std::chrono_literals;
using sensor::FixQuality;
using sensor::GnssFix;

constexpr Stamp kReceived{1'700'000'000s};

std::string rmc_at(const char* time, const char* status = "A") {
  return framed("GNRMC," + std::string(time) + "," + status + ",4807.038,N,01131.000,E,1.0,90.0,230326,,,A");
}

std::string gga_at(const char* time, int quality = 1) {
  return framed("GNGGA," + std::string(time) + ",4807.038,N,01131.000,E," + std::to_string(quality) +
                ",08,0.9,545.4,M,46.9,M,,");
}

std::string gst_at(const char* time, const char* latitude_std_m = "3.0") {
  return framed("GNGST," + std::string(time) + ",,,,," + latitude_std_m + ",4.0,6.0");
}

std::string text_of(const UbxBytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

NavPvt golden_pvt() { return NavPvt::parse(read_ubx(from_hex(kPvt3d)).payload).value(); }

std::string pvt_text(const NavPvt& pvt) {
  const auto payload = pvt.bytes();
  return text_of(write_ubx({ubx::kNav, ubx::kNavPvt, payload.view()}));
}

std::vector<GnssFix> fixes_of(GnssStream& stream, const std::string& text) {
  return gnss::fixes_of(stream, bytes_of(text), kReceived);
}

std::vector<GnssFix> finished(GnssStream& stream) {
  std::vector<GnssFix> fixes;
  stream.finish(kReceived, [&](const GnssFix& fix) { fixes.push_back(fix); });
  return fixes;
}

FixVerdict verdict_on(NavPvt pvt) {
  FixEpoch epoch;
  epoch.pvt = pvt;
  GnssFix fix;
  const FixVerdict verdict = epoch.merge(fix);
  EXPECT_EQ(fix.is_good(), verdict == FixVerdict::kGood);
  return verdict;
}

TEST(GnssStream, MergesTheSentencesOfAMomentIntoOneFix) {
  GnssStream sut;

  EXPECT_TRUE(fixes_of(sut, rmc_at("101112.00") + gga_at("101112.00", 4) + gst_at("101112.00")).empty());
  const auto fixes = fixes_of(sut, rmc_at("101113.00"));

  ASSERT_EQ(fixes.size(), 1U);
  const GnssFix& fix = fixes.front();
  EXPECT_EQ(fix.stamp, kReceived);
  EXPECT_EQ(fix.quality, FixQuality::kRtkFixed);
  EXPECT_EQ(fix.utc->time_since_epoch(), 1'774'260'672s);  // 2026-03-23 10:11:12
  EXPECT_NEAR(fix.latitude_deg, 48.1173, 1e-9);
  EXPECT_DOUBLE_EQ(*fix.altitude_m, 592.3);
  EXPECT_EQ(fix.satellites, 8);
  EXPECT_DOUBLE_EQ(*fix.hdop, 0.9);
  EXPECT_DOUBLE_EQ(*fix.horizontal_std_m, 5.0);
  EXPECT_DOUBLE_EQ(*fix.vertical_std_m, 6.0);
  EXPECT_NEAR(*fix.speed_mps, 0.514444, 1e-6);
  EXPECT_DOUBLE_EQ(*fix.course_deg, 90.0);
}

TEST(GnssStream, DoesNotWaitForTheNextMomentOnceItKnowsWhatComes) {
  GnssStream sut;
  fixes_of(sut, gga_at("101112.00") + rmc_at("101112.00") + gga_at("101113.00"));

  const auto fixes = fixes_of(sut, rmc_at("101113.00"));

  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_TRUE(fixes.front().altitude_m && fixes.front().utc);
}

TEST(GnssStream, LearnsThatMoreComesWithoutMakingASecondFix) {
  GnssStream sut;
  std::vector<GnssFix> fixes = fixes_of(sut, rmc_at("101112.00") + rmc_at("101113.00"));
  ASSERT_EQ(fixes.size(), 2U);

  fixes = fixes_of(sut, gga_at("101113.00") + rmc_at("101114.00"));  // too late for its own moment
  EXPECT_TRUE(fixes.empty());
  fixes = fixes_of(sut, gga_at("101114.00"));

  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_TRUE(fixes.front().altitude_m);
  EXPECT_EQ(sut.counters().of(MessageResult::kLate), 1U);
}

TEST(GnssStream, GoesOnWhenAKindStaysAway) {
  GnssStream sut;
  fixes_of(sut, gga_at("101112.00") + rmc_at("101112.00") + gga_at("101113.00") + rmc_at("101113.00"));

  EXPECT_TRUE(fixes_of(sut, gga_at("101114.00")).empty());
  EXPECT_EQ(fixes_of(sut, gga_at("101115.00")).size(), 2U);  // that of the moment before, and this one
  EXPECT_EQ(fixes_of(sut, gga_at("101116.00")).size(), 1U);
}

TEST(GnssStream, CountsARepeatedSentenceOnce) {
  GnssStream sut;
  std::size_t fixes = 0;
  const auto visit = [&](const GnssFix&) { ++fixes; };
  for (int i = 0; i < 10; ++i) {  // as the position packets of a Velodyne have it
    sut.add_sentence(kRmcTextbook, kReceived, visit);
  }
  sut.add_sentence(kRmcRtk, kReceived, visit);
  sut.add_sentence(kRmcRtk, kReceived, visit);

  EXPECT_EQ(fixes, 2U);
  EXPECT_EQ(sut.counters().of(MessageResult::kRepeated), 1U);
  EXPECT_EQ(sut.counters().of(MessageResult::kPart), 11U);
}

TEST(GnssStream, TakesUbxAndSentencesOfOneMomentForOneFix) {
  GnssStream sut;
  // The receiver's second begins 0.35 ms before; its sentence says .60.
  const std::string moment = framed("GNRMC,044610.60,A,2302.6288,N,11323.4369,E,0.02,298.3,300926,,,A") +
                             pvt_text(golden_pvt()) + framed("GNGGA,044610.60,2302.6,N,11323.4,E,1,12,0.8,20.5,M,-5.1,M,,");

  fixes_of(sut, moment);
  const auto fixes = finished(sut);

  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_EQ(fixes[0].utc->time_since_epoch(), 1'790'743'570'599'649'570ns);
  EXPECT_NEAR(fixes[0].latitude_deg, 23.0443813, 1e-9);
  EXPECT_NEAR(fixes[0].longitude_deg, 113.3906154, 1e-9);
  EXPECT_NEAR(*fixes[0].altitude_m, 15.444, 1e-9);
  EXPECT_EQ(fixes[0].satellites, 21);
  EXPECT_NEAR(*fixes[0].horizontal_std_m, 1.46, 1e-9);
  EXPECT_NEAR(*fixes[0].course_deg, 298.31344, 1e-9);
  EXPECT_DOUBLE_EQ(*fixes[0].hdop, 0.8);  // which NAV-PVT does not have
}

TEST(GnssStream, KnowsAMomentAcrossMidnight) {
  GnssStream sut;
  NavPvt pvt = golden_pvt();
  pvt.hour = pvt.minute = pvt.second = 0;
  pvt.nano_ns = -400'000;

  fixes_of(sut, framed("GNGGA,000000.00,2302.6,N,11323.4,E,1,12,0.8,20.5,M,-5.1,M,,") + pvt_text(pvt));
  EXPECT_EQ(finished(sut).size(), 1U);

  fixes_of(sut, framed("GNGGA,235959.99,2302.6,N,11323.4,E,1,12,0.8,20.5,M,-5.1,M,,") + pvt_text(pvt));
  EXPECT_EQ(finished(sut).size(), 1U);
}

TEST(GnssStream, NamesWhyANavPvtIsNoPosition) {
  const auto with = [](auto change) {
    NavPvt pvt = golden_pvt();
    change(pvt);
    return verdict_on(pvt);
  };

  EXPECT_EQ(with([](NavPvt&) {}), FixVerdict::kGood);
  EXPECT_EQ(verdict_on(NavPvt::parse(read_ubx(from_hex(kPvtTimeOnly)).payload).value()), FixVerdict::kTimeOnly);
  EXPECT_EQ(verdict_on(NavPvt::parse(read_ubx(from_hex(kPvtM8)).payload).value()), FixVerdict::kGood);
  EXPECT_EQ(with([](NavPvt& p) { p.fix_type = 0; }), FixVerdict::kNoFix);
  EXPECT_EQ(with([](NavPvt& p) { p.fix_type = 1; }), FixVerdict::kDeadReckoning);
  EXPECT_EQ(with([](NavPvt& p) { p.fix_type = 2; }), FixVerdict::kNoHeight);
  EXPECT_EQ(with([](NavPvt& p) { p.fix_type = 4; }), FixVerdict::kGood);
  EXPECT_EQ(with([](NavPvt& p) { p.fix_type = 6; }), FixVerdict::kNotSatellites);
  EXPECT_EQ(with([](NavPvt& p) { p.flags = 0; }), FixVerdict::kNotHeld);
  EXPECT_EQ(with([](NavPvt& p) { p.tail[0] |= std::byte{1}; }), FixVerdict::kNotHeld);
  EXPECT_EQ(with([](NavPvt& p) { p.valid = 2; }), FixVerdict::kNoTime);
  EXPECT_EQ(with([](NavPvt& p) { p.horizontal_accuracy_mm = 50'001; }), FixVerdict::kInaccurate);
  EXPECT_EQ(with([](NavPvt& p) { p.latitude_1e7deg = 900'000'001; }), FixVerdict::kOutOfRange);
}

TEST(GnssStream, TellsTheQualityOfEachSource) {
  const auto quality = [](const std::string& text) {
    GnssStream sut;
    fixes_of(sut, text);
    return finished(sut).at(0).quality;
  };
  const auto carrier = [&](std::uint8_t flags) {
    NavPvt pvt = golden_pvt();
    pvt.flags = flags;
    return quality(pvt_text(pvt));
  };

  EXPECT_EQ(carrier(0x01), FixQuality::kSingle);
  EXPECT_EQ(carrier(0x03), FixQuality::kDifferential);
  EXPECT_EQ(carrier(0x43), FixQuality::kRtkFloat);
  EXPECT_EQ(carrier(0x83), FixQuality::kRtkFixed);
  const FixQuality of_gga[] = {FixQuality::kNone,     FixQuality::kSingle,   FixQuality::kDifferential,
                               FixQuality::kSingle,   FixQuality::kRtkFixed, FixQuality::kRtkFloat,
                               FixQuality::kNone,     FixQuality::kNone,     FixQuality::kNone};
  for (int i = 0; i <= 8; ++i) {
    EXPECT_EQ(quality(gga_at("101112.00", i)), of_gga[i]) << i;
  }
  EXPECT_EQ(quality(std::string(kRmcRtk) + "\r\n"), FixQuality::kDifferential);
  EXPECT_EQ(quality(rmc_at("101112.00", "V")), FixQuality::kNone);
  EXPECT_EQ(quality(rmc_at("101112.00", "V") + gga_at("101112.00")), FixQuality::kNone);
  EXPECT_EQ(quality(rmc_at("101112.00") + gst_at("101112.00", "80.0")), FixQuality::kNone);
}

TEST(GnssStream, CountsByReason) {
  GnssStream sut;

  fixes_of(sut, framed("GNRMC,,V,,,,,,,,,,N") + framed("GNGGA,101112.00,9999.0,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,") +
                    framed("GPGSV,1,1,00") + text_of(write_ubx({0x0A, 0x38, {}})) + "$GNRMC,torn$GPGSV,1,1,00*00\r\n");

  const GnssCounters counters = sut.counters();
  EXPECT_EQ(counters.of(MessageResult::kNoTime), 1U);
  EXPECT_EQ(counters.of(MessageResult::kMalformed), 1U);
  EXPECT_EQ(counters.of(MessageResult::kOther), 2U);
  EXPECT_EQ(counters.stream.damaged, 2U);
  std::map<std::string, std::uint64_t> named;
  sut.each_count([&](const char* name, std::uint64_t count) { EXPECT_TRUE(named.emplace(name, count).second) << name; });
  EXPECT_EQ(named.at("without_time"), 1U);
  EXPECT_EQ(named.at("malformed"), 1U);
  EXPECT_EQ(named.at("fix"), 0U);
}

TEST(GnssStream, FindsItsPlaceAgainAfterAnyGarbage) {
  EXPECT_TRUE(rc::check([](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::string text;
    for (std::size_t i = random() % 50; i > 0; --i) {
      text += static_cast<char>("\xB5\x62$\xD3\x00*\r\nG0"[random() % 10]);
    }
    const std::size_t garbage = text.size();
    text.append(GnssFrames::kLongest, 'x');  // whatever began in there is over
    text += rmc_at("101112.00") + pvt_text(golden_pvt());
    GnssStream sut;
    GnssStream in_pieces;

    fixes_of(sut, text);
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t piece = std::min<std::size_t>(text.size() - at, 1 + random() % 99);
      fixes_of(in_pieces, text.substr(at, piece));
      at += piece;
    }

    RC_ASSERT(sut.counters().of(MessageResult::kPart) == 2U);
    RC_ASSERT(in_pieces.counters().messages == sut.counters().messages);
    RC_ASSERT(sut.counters().stream.skipped_bytes >= GnssFrames::kLongest);
    RC_ASSERT(sut.counters().stream.skipped_bytes <= garbage + GnssFrames::kLongest);
  }));
}

TEST(GnssStream, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  GnssStream sut;
  const std::string text = rmc_at("101112.00") + gga_at("101112.00") + gst_at("101112.00") + pvt_text(golden_pvt());
  std::size_t fixes = 0;

  const std::size_t count = support::count_allocations([&] {
    for (int i = 0; i < 3; ++i) {
      sut.add(bytes_of(text), kReceived, [&](const GnssFix&) { ++fixes; });
    }
  });

  EXPECT_EQ(count, 0U);
  EXPECT_GE(fixes, 3U);
}

}  // namespace
}  // namespace slamd::gnss
