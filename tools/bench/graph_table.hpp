#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/pose_graphs/graph_runs.hpp"

namespace slamd::bench {

/// What `slamd-bench graph` measures.
struct GraphBenchConfig {
  std::vector<std::size_t> keyframes = {1'000, 5'000};
  std::uint64_t seed = 201;
  int drives = 9;  // of each kind of campaign, of successive seeds; 0: speed only
};

/// The cost at one size: of the solver, of the dearest updates of a drive, and of all loops and fixes judged at once.
struct GraphSpeedRow {
  std::string course;
  pose_graphs::SpeedResult solver;
  pose_graphs::RunResult updates;
  pose_graphs::RunResult full;
};

/// One kind of campaign, summed over its drives.
struct GraphCampaignRow {
  std::string name;
  int drives = 0;
  pose_graphs::RunResult sum;        // counts added, errors the greatest
  double kept_share_min = 1.0;       // of the true loops of a drive
};

struct GraphTable {
  std::vector<GraphSpeedRow> speeds;
  std::vector<GraphCampaignRow> campaigns;
};

GraphTable measure_graph(const GraphBenchConfig& config, const std::function<void(double)>& progress);

std::string text_of(const GraphTable& table);
std::string json_of(const GraphTable& table);

}  // namespace slamd::bench
