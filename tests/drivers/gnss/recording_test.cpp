#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "receiver_bytes.hpp"

// Logs of real receivers beside what another program has read in them (../shared/data).
namespace slamd::gnss {
namespace {

using sensor::FixQuality;
using sensor::GnssFix;

std::filesystem::path recorded(const char* name) {
  return std::filesystem::path(SLAMD_SHARED_DATA_DIR) / "imu_gnss/gpsd_logs" / name;
}

#define SKIP_UNLESS_THERE(path)                                              \
  if (!std::filesystem::exists(path)) {                                      \
    GTEST_SKIP() << (path) << " is not there: real recordings are not read"; \
  }

/// The receiver's bytes: the log without the lines of comment that it begins with.
std::string receiver_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream all;
  all << stream.rdbuf();
  std::string text = all.str();
  while (text.starts_with('#')) {
    text.erase(0, text.find('\n') + 1);
  }
  return text;
}

struct Account {
  std::vector<GnssFix> fixes;
  GnssCounters counters;
  std::size_t size = 0;

  bool every_byte_is_known() const { return counters.stream.frame_bytes + counters.stream.skipped_bytes == size; }
};

Account account_of(const std::filesystem::path& file) {
  const std::string text = receiver_bytes(file);
  GnssStream stream;
  Account account;
  account.size = text.size();
  account.fixes = fixes_of(stream, bytes_of(text));
  stream.finish({}, [&](const GnssFix& fix) { account.fixes.push_back(fix); });
  account.counters = stream.counters();
  return account;
}

std::string iso_of(const GnssFix& fix) {
  const auto ms = std::chrono::round<std::chrono::milliseconds>(fix.utc->time_since_epoch());
  const auto days = std::chrono::floor<std::chrono::days>(std::chrono::sys_time<std::chrono::milliseconds>(ms));
  const std::chrono::year_month_day date{days};
  const std::chrono::hh_mm_ss time{std::chrono::sys_time<std::chrono::milliseconds>(ms) - days};
  char text[64];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), static_cast<int>(time.hours().count()),
                static_cast<int>(time.minutes().count()), static_cast<int>(time.seconds().count()),
                static_cast<int>(time.subseconds().count()));
  return text;
}

/// The published fixes by time; of several of one moment the last, which knows most.
std::map<std::string, nlohmann::json> published(const std::filesystem::path& file) {
  std::map<std::string, nlohmann::json> fixes;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(R"({"class":"TPV")")) {
      auto fix = nlohmann::json::parse(line);
      const std::string time = fix.at("time");
      fixes[time] = std::move(fix);
    }
  }
  return fixes;
}

/// Compares a fix with what was published of its moment; false when nothing was.
bool is_as_published(const GnssFix& fix, const std::map<std::string, nlohmann::json>& all) {
  const auto found = all.find(iso_of(fix));
  if (found == all.end()) {
    return false;
  }
  const nlohmann::json& is = found->second;
  EXPECT_NEAR(fix.latitude_deg, is.at("lat"), 2e-7) << found->first;
  EXPECT_NEAR(fix.longitude_deg, is.at("lon"), 2e-7) << found->first;
  EXPECT_NEAR(*fix.speed_mps, is.at("speed"), 2e-3) << found->first;
  if (is.contains("altHAE") && fix.altitude_m) {
    // A sum of two sentences' tenths; NAV-PVT has millimetres.
    EXPECT_NEAR(*fix.altitude_m, is.at("altHAE"), 0.1) << found->first;
  }
  return true;
}

TEST(GnssRecording, ReadsAQuectelsSentencesAsPublished) {
  SKIP_UNLESS_THERE(recorded("quectel-l76k-nmea.log"));

  const Account account = account_of(recorded("quectel-l76k-nmea.log"));
  const auto all = published(recorded("quectel-l76k-nmea.log.chk"));

  EXPECT_TRUE(account.every_byte_is_known());
  EXPECT_LT(account.counters.stream.skipped_bytes, GnssFrames::kLongestSentence);  // where the log was cut
  EXPECT_EQ(all.size(), 150U);
  ASSERT_EQ(account.fixes.size(), 151U);
  EXPECT_EQ(account.counters.of(FixVerdict::kGood), 151U);
  EXPECT_FALSE(account.fixes.back().utc);  // the log ends before that moment's date
  for (std::size_t i = 0; i < 150; ++i) {
    EXPECT_TRUE(is_as_published(account.fixes[i], all));
  }
}

TEST(GnssRecording, ReadsTheMixedStreamOfAnF9rAsPublished) {
  SKIP_UNLESS_THERE(recorded("ublox-zed-f9r.log"));

  const Account account = account_of(recorded("ublox-zed-f9r.log"));
  const auto all = published(recorded("ublox-zed-f9r.log.chk"));

  EXPECT_TRUE(account.every_byte_is_known());
  EXPECT_EQ(account.counters.stream.skipped_bytes, 1U);  // a line end of the log's own
  EXPECT_EQ(account.counters.stream.damaged, 0U);
  EXPECT_EQ(account.fixes.size(), 30U);  // of 30 NAV-PVT, RMC, GGA and GST each
  EXPECT_EQ(account.counters.of(MessageResult::kPart), 120U);
  EXPECT_EQ(account.counters.of(FixVerdict::kGood), 30U);
  std::size_t compared = 0;
  for (const GnssFix& fix : account.fixes) {
    EXPECT_EQ(fix.quality, FixQuality::kRtkFloat);
    EXPECT_TRUE(fix.hdop && fix.altitude_m && fix.horizontal_std_m);
    compared += is_as_published(fix, all) ? 1 : 0;
  }
  EXPECT_GE(compared, 29U);  // the first moment is published without its time
}

TEST(GnssRecording, ReadsTheMixedStreamOfAnF9p) {
  SKIP_UNLESS_THERE(recorded("ublox-zed-f9p_hpg1.11.log"));

  const Account account = account_of(recorded("ublox-zed-f9p_hpg1.11.log"));

  EXPECT_TRUE(account.every_byte_is_known());
  EXPECT_EQ(account.counters.stream.skipped_bytes, 377U);  // the rest of the frame in which the log begins
  EXPECT_EQ(account.counters.stream.damaged, 0U);
  EXPECT_EQ(account.fixes.size(), 655U);
  EXPECT_EQ(account.counters.of(MessageResult::kPart), 1310U);
  EXPECT_EQ(account.counters.of(FixVerdict::kGood), 655U);
  for (const GnssFix& fix : account.fixes) {
    EXPECT_NEAR(fix.latitude_deg, -45.8775915, 1e-4);  // as the log's own header says
    EXPECT_NEAR(fix.longitude_deg, 170.500124833, 1e-4);
  }
}

}  // namespace
}  // namespace slamd::gnss
