#include "tools/map/session_info.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <set>

#include <nlohmann/json.hpp>

namespace slamd::map {

namespace {

/// What is told of a session.
struct Summary {
  std::size_t points = 0;
  std::size_t submaps = 0;
  std::size_t accepted = 0;
  double way_m = 0.0;
  double duration_s = 0.0;
  double largest_correction_m = 0.0;
  Eigen::Vector3d low = Eigen::Vector3d::Zero();  // of the way in map
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
};

Summary summary_of(const storage::Session& session) {
  Summary summary;
  std::set<std::uint32_t> submaps;
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    const storage::SessionKeyframe& keyframe = session.keyframes[i];
    const Eigen::Vector3d p_map = session.T_map_base[i].translation();
    summary.points += keyframe.cloud_level.size();
    submaps.insert(keyframe.submap);
    summary.largest_correction_m = std::max(summary.largest_correction_m, (p_map - keyframe.T_odom_base.translation()).norm());
    summary.low = i == 0 ? p_map : summary.low.cwiseMin(p_map).eval();
    summary.high = i == 0 ? p_map : summary.high.cwiseMax(p_map).eval();
  }
  summary.submaps = submaps.size();
  summary.accepted = static_cast<std::size_t>(std::count_if(session.loops.begin(), session.loops.end(), [](const auto& loop) { return loop.accepted; }));
  if (!session.keyframes.empty()) {
    summary.way_m = session.keyframes.back().path_m - session.keyframes.front().path_m;
    summary.duration_s = to_seconds(session.keyframes.back().stamp - session.keyframes.front().stamp);
  }
  return summary;
}

/// The file's words, without what would move a terminal's cursor.
std::string printable(std::string words) {
  std::replace_if(words.begin(), words.end(), [](unsigned char c) { return c < 0x20 || c > 0x7E; }, '?');
  return words;
}

[[gnu::format(printf, 1, 2)]] std::string line(const char* format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return std::string(text) + "\n";
}

}  // namespace

std::string info_text(const storage::Session& session) {
  const Summary summary = summary_of(session);
  std::string text;
  text += line("written by   %s, LiDAR %s", printable(session.begin.software).c_str(), printable(session.begin.sensor).c_str());
  text += line("way          %.1f m in %.1f s", summary.way_m, summary.duration_s);
  text += line("keyframes    %zu in %zu submaps, %zu points", session.keyframes.size(), summary.submaps, summary.points);
  text += line("loops        %zu accepted, %zu not", summary.accepted, session.loops.size() - summary.accepted);
  text += line("correction   %.2f m at most", summary.largest_correction_m);
  text += line("extent       x %.1f to %.1f m, y %.1f to %.1f m, z %.1f to %.1f m", summary.low.x(), summary.high.x(), summary.low.y(), summary.high.y(),
               summary.low.z(), summary.high.z());
  text += line("files        %u, %.1f MB, %llu records", session.segments, 1e-6 * static_cast<double>(session.bytes),
               static_cast<unsigned long long>(session.records));
  text += line("end          %s", session.closed ? "closed in order" : "not closed: the writer still runs, or was stopped");
  if (session.lost_records > 0) {
    text += line("lost         %llu records are not there any more", static_cast<unsigned long long>(session.lost_records));
  }
  for (const storage::SessionDamage& damage : session.damage) {
    text += line("damaged      %s from byte %llu, %llu bytes: %s", damage.segment.c_str(), static_cast<unsigned long long>(damage.offset),
                 static_cast<unsigned long long>(damage.bytes), damage.what.c_str());
  }
  return text;
}

std::string info_json(const storage::Session& session) {
  const Summary summary = summary_of(session);
  nlohmann::ordered_json json{
      {"software", session.begin.software},
      {"sensor", session.begin.sensor},
      {"way_m", summary.way_m},
      {"duration_s", summary.duration_s},
      {"keyframes", session.keyframes.size()},
      {"submaps", summary.submaps},
      {"points", summary.points},
      {"loops", {{"accepted", summary.accepted}, {"not_accepted", session.loops.size() - summary.accepted}}},
      {"largest_correction_m", summary.largest_correction_m},
      {"low_m", {summary.low.x(), summary.low.y(), summary.low.z()}},
      {"high_m", {summary.high.x(), summary.high.y(), summary.high.z()}},
      {"segments", session.segments},
      {"bytes", session.bytes},
      {"records", session.records},
      {"lost_records", session.lost_records},
      {"closed", session.closed},
      {"damage", nlohmann::ordered_json::array()},
  };
  for (const storage::SessionDamage& damage : session.damage) {
    json["damage"].push_back({{"segment", damage.segment}, {"offset", damage.offset}, {"bytes", damage.bytes}, {"what", damage.what}});
  }
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace slamd::map
