#include "tools/bench/pose_latency_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace slamd::bench {

namespace {

/// The smallest value that a share of all do not exceed. `sorted` is not empty.
Duration percentile(const std::vector<Duration>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

double ms(Duration duration) { return 1e3 * to_seconds(duration); }

std::string load_of(const PoseLatencyRow& row) { return row.hogs == 0 ? "quiet" : std::to_string(row.hogs) + " hogs"; }

const char* scheduling_of(const PoseLatencyRow& row) { return row.fifo ? "SCHED_FIFO" : "SCHED_OTHER"; }

}  // namespace

PoseLatencyRow row_of(std::span<const Moment> sent, std::span<const Moment> heard) {
  PoseLatencyRow row;
  if (heard.empty()) {
    return row;
  }
  const auto by_stamp = [](const Moment& a, const Moment& b) { return a.stamp < b.stamp; };
  const Stamp first = std::min_element(heard.begin(), heard.end(), by_stamp)->stamp;
  const auto begin = std::lower_bound(sent.begin(), sent.end(), Moment{first, {}}, by_stamp);
  row.sent = static_cast<std::uint64_t>(sent.end() - begin);
  std::vector<bool> seen(sent.size());
  std::vector<Duration> latencies;
  for (const Moment& pose : heard) {
    const auto sample = std::lower_bound(begin, sent.end(), pose, by_stamp);
    const auto place = static_cast<std::size_t>(sample - sent.begin());
    if (sample == sent.end() || sample->stamp != pose.stamp || seen[place]) {
      continue;
    }
    seen[place] = true;
    latencies.push_back(pose.instant - sample->instant);
  }
  row.heard = latencies.size();
  if (latencies.empty()) {
    return row;
  }
  std::sort(latencies.begin(), latencies.end());
  row.p50 = percentile(latencies, 0.5);
  row.p99 = percentile(latencies, 0.99);
  row.p999 = percentile(latencies, 0.999);
  row.max = latencies.back();
  return row;
}

std::string table_of(const std::vector<PoseLatencyRow>& rows) {
  char line[160];
  std::snprintf(line, sizeof line, "%-8s %-12s %9s %9s %9s %9s %10s %8s\n", "load", "scheduling", "p50 ms", "p99 ms", "p99.9 ms",
                "max ms", "delivered", "p99 x");
  std::string text = line;
  for (const PoseLatencyRow& row : rows) {
    std::snprintf(line, sizeof line, "%-8s %-12s %9.3f %9.3f %9.3f %9.3f %9.3f%% %8.2f\n", load_of(row).c_str(), scheduling_of(row),
                  ms(row.p50), ms(row.p99), ms(row.p999), ms(row.max), 100.0 * row.delivered(), ms(row.p99) / ms(rows.front().p99));
    text += line;
  }
  return text;
}

std::string json_of(const std::vector<PoseLatencyRow>& rows, std::size_t pose_bytes, double imu_rate_hz) {
  nlohmann::ordered_json json;
  json["pose_bytes"] = pose_bytes;
  json["imu_rate_hz"] = imu_rate_hz;
  json["rows"] = nlohmann::ordered_json::array();
  for (const PoseLatencyRow& row : rows) {
    json["rows"].push_back({{"hogs", row.hogs},
                            {"scheduling", scheduling_of(row)},
                            {"samples", row.sent},
                            {"poses", row.heard},
                            {"delivered", row.delivered()},
                            {"latency_ms", {{"p50", ms(row.p50)}, {"p99", ms(row.p99)}, {"p99.9", ms(row.p999)}, {"max", ms(row.max)}}}});
  }
  return json.dump(2) + "\n";
}

}  // namespace slamd::bench
