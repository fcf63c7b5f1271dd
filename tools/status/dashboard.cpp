#include "tools/status/dashboard.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <vector>

#include "core/base/units.hpp"
#include "core/geometry/so3.hpp"

namespace slamd::status {

namespace {

constexpr std::chrono::seconds kSilence{3};
constexpr const char* kAxes[] = {"x", "y", "z", "roll", "pitch", "yaw"};

[[gnu::format(printf, 1, 2)]] std::string line(const char* format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

std::string of(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    c = static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? ' ' : c;
  }
  return result;
}

/// Cuts to a number of characters (not bytes).
std::string cut(const std::string& text, std::size_t columns) {
  std::size_t characters = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U && ++characters > columns) {
      return text.substr(0, i);
    }
  }
  return text;
}

constexpr const char* kRed = "\033[31m";

const char* colour_of(bus::State state) {
  switch (state) {
    case bus::State::kTracking: return "\033[32m";
    case bus::State::kLost: return kRed;
    default: return "\033[33m";
  }
}

std::string axes_of(std::uint8_t weak_axes) {
  std::string names;
  for (unsigned bit = 0; bit < 6; ++bit) {
    if ((weak_axes >> bit & 1U) != 0) {
      names += (names.empty() ? "" : " ") + std::string(kAxes[bit]);
    }
  }
  return names.empty() ? "none" : names;
}

std::string age_of(Clock::time_point when, Clock::time_point now) {
  return line("%.1f s ago", std::max(0.0, to_seconds(now - when)));
}

void draw_pose(const bus::Pose& pose, std::vector<std::string>& lines) {
  const Eigen::Vector3d& p = pose.T_odom_base.translation();
  const Eigen::Vector3d rpy_deg = geometry::rpy_from_rotation(pose.T_odom_base.rotation()) / kDegree;
  const auto std_of = [&pose](int i) { return std::sqrt(std::max(0.0, pose.P_odom_base(i, i))); };
  lines.push_back(line("pose  x %8.2f  y %8.2f  z %7.2f m  roll %6.1f pitch %6.1f yaw %6.1f", p.x(), p.y(), p.z(),
                       rpy_deg.x(), rpy_deg.y(), rpy_deg.z()));
  lines.push_back(line("  std x %8.3f  y %8.3f  z %7.3f m  roll %6.2f pitch %6.2f yaw %6.2f", std_of(0), std_of(1),
                       std_of(2), std_of(3) / kDegree, std_of(4) / kDegree, std_of(5) / kDegree));
  lines.push_back(line("  speed %.2f m/s   resets %u   correction %u   message age %.2f ms", pose.v_odom_base.norm(),
                       pose.reset_counter, pose.correction_id, 1e3 * to_seconds(pose.age)));
}

void draw_health(const bus::Health& health, std::vector<std::string>& lines) {
  for (const auto& cause : health.causes) {
    lines.push_back("  because " + of(cause.view()));
  }
  if (!health.sensors.empty()) {
    lines.emplace_back("sensor         state              Hz  received    lost dropped time       res us");
    for (const auto& s : health.sensors) {
      lines.push_back(line("  %-12s %-14s %6.1f %9llu %7llu %7llu %-9s %6.0f", of(s.name.view()).c_str(), name_of(s.state),
                           static_cast<double>(s.rate_hz), static_cast<unsigned long long>(s.received),
                           static_cast<unsigned long long>(s.lost), static_cast<unsigned long long>(s.dropped),
                           name_of(s.time), static_cast<double>(s.time_residual_us)));
    }
  }
  if (!health.stages.empty()) {
    lines.emplace_back("stage                p50 ms     p99 ms     max ms      count");
    for (const auto& s : health.stages) {
      lines.push_back(line("  %-15s %10.2f %10.2f %10.2f %10u", of(s.name.view()).c_str(), 1e-3 * static_cast<double>(s.p50_us),
                           1e-3 * static_cast<double>(s.p99_us), 1e-3 * static_cast<double>(s.max_us), s.count));
    }
  }
  lines.push_back(line("weak axes %s   swarm %.0f %% of scans, %u particles   inliers %.0f %%", axes_of(health.weak_axes).c_str(),
                       100.0 * static_cast<double>(health.swarm_use), health.particles,
                       100.0 * static_cast<double>(health.inlier_share)));
  if (health.imu_offset_std_ms > 0.0F) {
    lines.push_back(line("imu stamps %+.1f ms against the lidar's (1σ %.1f ms)", static_cast<double>(health.imu_offset_ms),
                         static_cast<double>(health.imu_offset_std_ms)));
  }
  std::string pools;
  for (const auto& pool : health.pools) {
    pools += line("  %s %u/%u", of(pool.name.view()).c_str(), pool.low_water, pool.capacity);
  }
  if (!pools.empty()) {
    lines.push_back("fewest free" + pools);
  }
  std::string counters;
  for (const auto& counter : health.counters) {
    counters += line("  %s %llu", of(counter.name.view()).c_str(), static_cast<unsigned long long>(counter.value));
  }
  if (!counters.empty()) {
    lines.push_back("counters" + counters);
  }
}

}  // namespace

std::string draw(const Heard& heard, Clock::time_point now, const Look& look) {
  if (!heard.anything()) {
    return "nothing heard on " + look.url + " prefix " + look.prefix + ": is slamd running? multicast route?\n";
  }
  std::vector<std::string> lines;
  const auto& health = heard.health.message;
  const auto& pose = heard.pose.message;
  const bool has_state = health || pose;
  const bus::State state = health ? health->state : pose ? pose->state : bus::State::kStarting;
  const auto newest = std::max({heard.health.when, heard.pose.when, heard.map_to_odom.when});
  const bool silent = now - newest > kSilence;
  const std::string name = std::string(silent ? "SILENT, was " : "") + (has_state ? name_of(state) : "?");
  lines.push_back(name + "   " + look.prefix +
                  (health ? line("   up %.0f s   health ", to_seconds(health->uptime)) + age_of(heard.health.when, now)
                          : "   no health heard") +
                  (pose ? (heard.pose_rate_hz > 0.0 ? line("   pose %.0f Hz, ", heard.pose_rate_hz) : "   pose ") + age_of(heard.pose.when, now) : "   no pose heard"));
  if (pose) {
    draw_pose(*pose, lines);
  }
  if (health) {
    draw_health(*health, lines);
  }
  lines.push_back(line("scans heard %llu, incomplete %llu   malformed messages %llu",
                       static_cast<unsigned long long>(heard.scans), static_cast<unsigned long long>(heard.scans_incomplete),
                       static_cast<unsigned long long>(heard.malformed)));
  std::string result;
  for (std::size_t i = 0; i < lines.size() && i + 1 < look.rows; ++i) {  // the last row is the cursor's
    std::string text = cut(lines[i], look.columns);
    if (i == 0 && look.colour && has_state) {
      text = (silent ? kRed : colour_of(state)) + text.insert(std::min(name.size(), text.size()), "\033[0m");
    }
    result += text + "\n";
  }
  return result;
}

}  // namespace slamd::status
