#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "drivers/gnss/gnss_stream.hpp"
#include "drivers/recording/packet.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/cli/cli.hpp"
#include "tools/replay/emulated_gnss.hpp"
#include "tools/replay/gnss_log.hpp"
#include "tools/replay/network_player.hpp"

namespace slamd::replay {
namespace {

using namespace std::chrono_literals;
using sensor::FixQuality;
using sensor::GnssFix;

constexpr sensor::UtcStamp kUtc{1'774'260'672'200ms};

GnssFix told_fix() {
  GnssFix fix;
  fix.utc = kUtc;
  fix.quality = FixQuality::kRtkFloat;
  fix.latitude_deg = -33.7583336;
  fix.longitude_deg = -70.5000001;
  fix.altitude_m = 592.3;
  fix.satellites = 11;
  fix.hdop = 0.9;
  fix.horizontal_std_m = 0.5;
  fix.vertical_std_m = 0.8;
  fix.speed_mps = 1.25;
  fix.course_deg = 271.5;
  return fix;
}

std::vector<GnssFix> heard(const std::string& bytes) {
  gnss::GnssStream stream;
  std::vector<GnssFix> fixes;
  const auto visit = [&](const GnssFix& fix) { fixes.push_back(fix); };
  stream.add(std::as_bytes(std::span(bytes)), Stamp{}, visit);
  stream.finish(Stamp{}, visit);
  EXPECT_EQ(stream.counters().stream.skipped_bytes, 0U);
  return fixes;
}

TEST(EmulatedGnss, IsHeardAsItWasTold) {
  for (const GnssTalk talk : {GnssTalk::kNmea, GnssTalk::kUbx, GnssTalk::kBoth}) {
    const auto fixes = heard(message_of(told_fix(), talk));

    ASSERT_EQ(fixes.size(), 1U);
    const GnssFix& fix = fixes[0];
    EXPECT_EQ(fix.utc, kUtc);
    // RMC says no more than that there is a fix; GGA and NAV-PVT say of which kind.
    EXPECT_EQ(fix.quality, FixQuality::kRtkFloat);
    EXPECT_NEAR(fix.latitude_deg, -33.7583336, 6e-8);
    EXPECT_NEAR(fix.longitude_deg, -70.5000001, 6e-8);
    EXPECT_NEAR(*fix.altitude_m, 592.3, 1e-3);
    EXPECT_EQ(fix.satellites, 11);
    EXPECT_EQ(fix.hdop.has_value(), talk != GnssTalk::kUbx);
    EXPECT_NEAR(*fix.horizontal_std_m, 0.5, 1e-3);
    EXPECT_NEAR(*fix.vertical_std_m, 0.8, 1e-3);
    EXPECT_NEAR(*fix.speed_mps, 1.25, 1e-3);
    EXPECT_NEAR(*fix.course_deg, 271.5, 1e-3);
  }
}

TEST(EmulatedGnss, TellsThatItHasNoFix) {
  GnssFix none;
  none.utc = kUtc;

  for (const GnssTalk talk : {GnssTalk::kNmea, GnssTalk::kUbx, GnssTalk::kBoth}) {
    const auto fixes = heard(message_of(none, talk));

    ASSERT_EQ(fixes.size(), 1U);
    EXPECT_FALSE(fixes[0].is_good());
  }
}

TEST(GnssDestination, ReadsWhatIsSpokenAndWhere) {
  ToNetworkOptions sut;

  parse_gnss_destination("both:/run/a:b", sut);

  EXPECT_EQ(sut.gnss_terminal, "/run/a:b");
  EXPECT_EQ(sut.gnss_talk, GnssTalk::kBoth);
  parse_gnss_destination("ubx:gnss", sut);
  EXPECT_EQ(sut.gnss_talk, GnssTalk::kUbx);
  for (const char* text : {"", "nmea", "ubx:", "pty:/run/gnss", ":x"}) {
    EXPECT_THROW(parse_gnss_destination(text, sut), cli::UsageError) << text;
  }
}

class ReadGnss : public scratch::ScratchFolder {};

TEST_F(ReadGnss, SummarisesRows) {
  const auto file = write("gnss.csv", "timestamp_ns,quality,lat_deg,lon_deg,alt_m,sats,hdop,speed_m_s,course_deg\n"
                                      "1000000000,1,52.4,13.5,34.0,11,0.9,0.1,10\n"
                                      "2000000000,0,0,0,0,0,99.9,0,0\n"
                                      "3000000000,7,52.4,13.5,34.0,11,0.9,0.1,10\n"
                                      "4000000000,1,152.4,13.5,34.0,11,0.9,0.1,10\n"
                                      "4000000000,1,x,13.5,34.0,11,0.9,0.1,10\n"
                                      "5500000000,4,52.4,13.5,35.0,11,0.9,0.1,10\n");

  const GnssSummary sut = read_gnss(file);

  EXPECT_EQ(sut.state.good, 2U);
  EXPECT_EQ(sut.refused, (stages::NamedCounts{{"no_fix", 3}, {"row_not_a_number", 1}}));
  EXPECT_EQ(sut.state.span(), 4500ms);
  ASSERT_TRUE(sut.state.origin);
  EXPECT_EQ(sut.state.origin->altitude_m, 34.0);
  EXPECT_NEAR(sut.state.p_enu_antenna_m[2], 1.0, 1e-9);
}

TEST_F(ReadGnss, SummarisesWhatAReceiversPortCarried) {
  GnssFix later = told_fix();
  later.utc = kUtc + 2s;
  GnssFix none;
  none.utc = kUtc + 3s;
  const auto file = write("gnss.ubx", "noise" + message_of(told_fix(), GnssTalk::kBoth) + message_of(later, GnssTalk::kBoth) +
                                          message_of(none, GnssTalk::kBoth));

  const GnssSummary sut = read_gnss(file);

  EXPECT_EQ(sut.state.good, 2U);
  EXPECT_EQ(sut.refused, (stages::NamedCounts{{"no_fix", 1}, {"skipped_bytes", 5}}));
  EXPECT_EQ(sut.state.span(), 2s);
}

TEST_F(ReadGnss, NamesAFileThatCannotBeRead) {
  EXPECT_THROW(read_gnss(folder_ / "none.nmea"), recording::RecordingError);
  EXPECT_THROW(read_gnss(folder_ / "none.csv"), recording::RecordingError);
}

}  // namespace
}  // namespace slamd::replay
