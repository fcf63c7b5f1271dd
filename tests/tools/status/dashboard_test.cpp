#include "tools/status/dashboard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/daemon/bus/made_messages.hpp"
#include "tools/status/json.hpp"

namespace slamd::status {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const Clock::time_point kNow{std::chrono::hours(1)};
const Look kLook{.url = "udpm://239.255.76.67:7667?ttl=0", .prefix = "SLAMD"};

Heard made_heard() {
  Heard heard;
  heard.pose.message = bus::made_pose();
  heard.pose.when = kNow - std::chrono::milliseconds(1500);
  heard.pose_rate_hz = 199.7;
  bus::Health health;
  health.state = bus::State::kDegraded;
  health.uptime = std::chrono::seconds(75);
  health.weak_axes = 0b100001;
  health.causes.push_back("imu: silent for 1.2 s");
  health.sensors.push_back({.name = "vlp16", .state = bus::SensorState::kRunning, .time = bus::TimeState::kLocked,
                            .rate_hz = 9.9F, .received = 4321, .lost = 17});
  health.stages.push_back({.name = "odometry", .p50_us = 12340.0F, .p99_us = 45600.0F, .max_us = 78900.0F, .count = 99});
  health.pools.push_back({.name = "scans", .capacity = 8, .low_water = 5});
  heard.health.message = health;
  heard.health.when = kNow - std::chrono::milliseconds(300);
  return heard;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

TEST(Dashboard, SaysWhereItListensWhenNothingIsHeard) {
  EXPECT_EQ(draw(Heard{}, kNow, kLook),
            "nothing heard on udpm://239.255.76.67:7667?ttl=0 prefix SLAMD: is slamd running? multicast route?\n");
}

TEST(Dashboard, ShowsStateCausesSensorsLatencyAndPose) {
  const std::string text = draw(made_heard(), kNow, kLook);

  EXPECT_THAT(text, StartsWith("DEGRADED   SLAMD   up 75 s   health 0.3 s ago   pose 200 Hz, 1.5 s ago\n"));
  EXPECT_THAT(text, HasSubstr("because imu: silent for 1.2 s\n"));
  EXPECT_THAT(text, HasSubstr("  vlp16        running           9.9      4321      17       0 locked"));
  EXPECT_THAT(text, HasSubstr("  odometry             12.34      45.60      78.90         99\n"));
  EXPECT_THAT(text, HasSubstr("pose  x     1.00  y    -2.00  z    0.50 m"));
  EXPECT_THAT(text, HasSubstr("  std x    0.000  y    3.317"));  // the root of 11
  EXPECT_THAT(text, HasSubstr("weak axes x yaw "));
  EXPECT_THAT(text, HasSubstr("scans 5/8"));
}

TEST(Dashboard, SaysWhenTheDaemonFellSilent) {
  const Heard heard = made_heard();

  const std::string text = draw(heard, kNow + std::chrono::seconds(10), kLook);

  EXPECT_THAT(text, StartsWith("SILENT, was DEGRADED   SLAMD   up 75 s   health 10.3 s ago"));
}

TEST(Dashboard, NeedsNoMoreThan80Columns) {
  Look wide = kLook;
  wide.columns = 1000;

  const auto lines = lines_of(draw(made_heard(), kNow, wide));

  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_LE(lines[i].size(), 80U) << lines[i];
  }
}

TEST(Dashboard, FitsTheTerminalHoweverMuchThereIsToTell) {
  Heard heard = made_heard();
  heard.health.message = bus::full_health();

  const auto lines = lines_of(draw(heard, kNow, kLook));

  EXPECT_LE(lines.size(), 23U);
  for (const std::string& line : lines) {
    EXPECT_LE(line.size(), 80U) << line;
  }
}

TEST(Dashboard, ColoursTheStateOnlyWhenAsked) {
  Look colourful = kLook;
  colourful.colour = true;

  EXPECT_THAT(draw(made_heard(), kNow, kLook), Not(HasSubstr("\033")));
  EXPECT_THAT(draw(made_heard(), kNow, colourful), StartsWith("\033[33mDEGRADED\033[0m "));
}

TEST(Dashboard, LetsNoMessageMoveTheCursor) {
  Heard heard = made_heard();
  heard.health.message->causes.push_back("\033[2J");

  EXPECT_THAT(draw(heard, kNow, kLook), Not(HasSubstr("\033")));
}

TEST(StatusJson, HasWhatWasHeardAndNullForTheRest) {
  const auto json = nlohmann::json::parse(to_json(made_heard(), kNow));

  EXPECT_EQ(json["health"]["state"], "DEGRADED");
  EXPECT_EQ(json["health"]["sensors"][0]["lost"], 17);
  EXPECT_EQ(json["health"]["stages"][0]["name"], "odometry");
  EXPECT_EQ(json["pose"]["T_odom_base"]["position_m"][1], -2.0);
  EXPECT_EQ(json["pose"]["cause"], "degenerate");
  EXPECT_EQ(json["pose"]["heard_ago_s"], 1.5);
  EXPECT_TRUE(json["map_to_odom"].is_null());
}

TEST(StatusJson, SurvivesTextThatIsNoUtf8) {
  Heard heard = made_heard();
  heard.health.message->causes.push_back("\xFF\xFE");

  EXPECT_FALSE(nlohmann::json::parse(to_json(heard, kNow)).is_discarded());
}

}  // namespace
}  // namespace slamd::status
