#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/replay/network_player.hpp"

namespace slamd::replay {

namespace {

double ms(Duration duration) { return 1e3 * to_seconds(duration); }

}  // namespace

std::string json_of(const ToNetworkReport& report) {
  nlohmann::ordered_json json;
  json["sent"] = {{"lidar", report.lidar},
                  {"position", report.position},
                  {"imu_packets", report.imu_packets},
                  {"imu_rows", report.imu_rows},
                  {"gnss_fixes", report.gnss_fixes},
                  {"can_frames", report.can_frames}};
  json["not_sent"] = {{"foreign", report.foreign},
                      {"imu_unheard", report.imu_unheard},
                      {"gnss_unheard", report.gnss_unheard},
                      {"imu_withheld", report.imu_withheld},
                      {"imu_outside", report.imu_outside},
                      {"imu_refused", report.imu_refused},
                      {"can_outside", report.can_outside},
                      {"can_refused", report.can_refused}};
  json["lateness_ms"] = {{"mean", ms(report.mean_lateness)}, {"worst", ms(report.worst_lateness)}};
  json["recording_s"] = to_seconds(report.recording);
  json["took_s"] = to_seconds(report.took);
  json["wall_minus_recorded_s"] = to_seconds(report.wall_minus_recorded);
  json["interrupted"] = report.interrupted;
  return json.dump(2) + "\n";
}

std::string summary_of(const ToNetworkReport& report) {
  char text[512];
  std::snprintf(text,
                sizeof text,
                "sent %llu LiDAR, %llu position and %llu inertial packets, %llu inertial rows and %llu CAN frames: %.1f s of the recording in "
                "%.1f s%s\n  late by %.3f ms (mean), %.3f ms (worst)\n",
                static_cast<unsigned long long>(report.lidar),
                static_cast<unsigned long long>(report.position),
                static_cast<unsigned long long>(report.imu_packets),
                static_cast<unsigned long long>(report.imu_rows),
                static_cast<unsigned long long>(report.can_frames),
                to_seconds(report.recording),
                to_seconds(report.took),
                report.interrupted ? ", then interrupted" : "",
                ms(report.mean_lateness),
                ms(report.worst_lateness));
  std::string result = text;
  if (report.gnss_fixes != 0) {
    result += "  and " + std::to_string(report.gnss_fixes) + " fixes of the satellite receiver\n";
  }
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count != 0) {
      result += "  not sent: " + std::to_string(count) + " " + what + "\n";
    }
  };
  add(report.foreign, "frames that are none of the LiDAR's");
  add(report.imu_unheard, "inertial rows that nobody read from the terminal");
  add(report.gnss_unheard, "fixes that nobody read from the terminal");
  add(report.imu_withheld, "inertial rows that the emulated sensor was not told to send");
  add(report.imu_outside, "inertial rows from before or after the LiDAR's packets");
  add(report.imu_refused, "bad inertial rows");
  add(report.can_outside, "CAN frames from before or after the LiDAR's packets");
  add(report.can_refused, "lines of candump logs that are no frames with data");
  return result;
}

}  // namespace slamd::replay
