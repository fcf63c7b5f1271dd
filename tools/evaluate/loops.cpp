#include "tools/evaluate/loops.hpp"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/base/units.hpp"
#include "drivers/storage/session_reader.hpp"
#include "tools/evaluate/evaluate.hpp"

namespace slamd::evaluate {

using evaluation::ClaimedLoop;
using evaluation::LoopQuality;
using nlohmann::ordered_json;

namespace {

std::string table_of(const LoopQuality& quality) {
  char text[400];
  std::snprintf(text, sizeof text,
                "revisits  %zu m of the way, %zu of them closed (%.1f %%)\n"
                "opposite  %zu m, %zu closed\n"
                "loops     %zu, %zu wrong; off the truth by %.3f m (median), %.3f m and %.2f deg at most\n",
                quality.revisits, quality.closed, 100.0 * quality.recall(), quality.opposite, quality.opposite_closed, quality.loops,
                quality.wrong, quality.median_m, quality.worst_m, quality.worst_rad / kDegree);
  return text;
}

}  // namespace

std::vector<ClaimedLoop> read_loops(const std::filesystem::path& folder) {
  const storage::Session session = storage::read_session(folder);
  const auto stamp_of = [&](graph::KeyframeId id) {
    return std::lower_bound(session.keyframes.begin(), session.keyframes.end(), id,
                            [](const storage::SessionKeyframe& keyframe, graph::KeyframeId wanted) { return keyframe.id < wanted; })
        ->stamp;
  };
  std::vector<ClaimedLoop> loops;
  for (const storage::SessionLoop& loop : session.loops) {
    if (loop.accepted) {
      loops.push_back({stamp_of(loop.a), stamp_of(loop.b), loop.factor.T_a_b});
    }
  }
  return loops;
}

std::string json_of(const LoopQuality& quality) {
  return ordered_json{{"revisits_m", quality.revisits},
                      {"closed_m", quality.closed},
                      {"recall", quality.recall()},
                      {"opposite_m", quality.opposite},
                      {"opposite_closed_m", quality.opposite_closed},
                      {"loops", quality.loops},
                      {"wrong", quality.wrong},
                      {"median_m", quality.median_m},
                      {"worst_m", quality.worst_m},
                      {"worst_deg", quality.worst_rad / kDegree}}
             .dump(2) +
         "\n";
}

std::string evaluate_loops(const LoopOptions& options) {
  evaluation::RevisitRule rule;
  rule.near_m = options.near_m;
  rule.view_rad = options.view_deg * kDegree;
  rule.within_m = options.within_m;
  const LoopQuality quality = evaluation::loop_quality_of(read_trajectory(options.truth), read_loops(options.session), rule);
  return options.json ? json_of(quality) : table_of(quality);
}

}  // namespace slamd::evaluate
