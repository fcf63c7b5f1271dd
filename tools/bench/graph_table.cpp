#include "tools/bench/graph_table.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/pose_graphs/synthetic_graph.hpp"

namespace slamd::bench {

using pose_graphs::Course;
using pose_graphs::RunResult;
using pose_graphs::SyntheticConfig;

namespace {

struct NamedCourse {
  Course course;
  const char* name;
};

constexpr std::array<NamedCourse, 3> kCourses = {{{Course::kGrid, "grid"}, {Course::kSphere, "sphere"}, {Course::kTown, "town"}}};
constexpr std::size_t kKeyframesPerLoop = 16;  // 5,000 keyframes have about 300 loops

/// A kind of campaign.
struct Kind {
  const char* name;
  double step_yaw_rad;
  bool loops;
  bool gnss;
  bool gates;  // consistency before the graph, as shipped; without: graduated non-convexity alone
};

constexpr std::array<Kind, 5> kKinds = {{
    {"as they come", 0.0005, true, false, true},
    {"as they come, 3 x drift", 0.0015, true, false, true},
    {"GNC alone, 3 x drift", 0.0015, true, false, false},
    {"GNSS", 0.0005, false, true, true},
    {"GNSS and loops, 3 x drift", 0.0015, true, true, true},
}};

SyntheticConfig speed_case(Course course, std::size_t keyframes, std::uint64_t seed) {
  SyntheticConfig config;
  config.course = course;
  config.keyframes = keyframes;
  config.loops = keyframes / kKeyframesPerLoop;
  config.seed = seed;
  return config;
}

GraphSpeedRow measure_size(const NamedCourse& course, std::size_t keyframes, std::uint64_t seed) {
  GraphSpeedRow row;
  row.course = course.name;
  SyntheticConfig config = speed_case(course.course, keyframes, seed);
  row.solver = pose_graphs::measure_speed(make_graph(config));
  config.false_share = 0.2;
  config.gnss = true;
  config.gnss_outage_s = 60.0;
  config.gnss_jump_m = 15.0;
  row.full = pose_graphs::run_gnc(make_graph(config), true);
  // Looser odometry, so that false loops come as far as the graph and all of it is judged anew now and then.
  config.gnss = false;
  config.false_near = 0.5;
  config.false_runs = 0.5;
  config.errors.step_yaw_rad = 0.0015;
  row.updates = pose_graphs::run_back_end(make_graph(config));
  return row;
}

SyntheticConfig campaign_case(const Kind& kind, Course course, std::uint64_t seed) {
  SyntheticConfig config;
  config.course = course;
  config.keyframes = 1'000;
  config.loops = kind.loops ? 80 : 0;
  config.false_share = kind.loops ? 0.2 : 0.0;
  config.false_near = 0.5;
  config.false_runs = 0.5;
  config.gnss = kind.gnss;
  config.gnss_outage_s = 60.0;
  config.gnss_jump_m = 15.0;
  config.errors.step_yaw_rad = kind.step_yaw_rad;
  config.seed = seed;
  return config;
}

void add(const RunResult& result, GraphCampaignRow& row) {
  ++row.drives;
  RunResult& sum = row.sum;
  sum.true_loops += result.true_loops;
  sum.true_kept += result.true_kept;
  sum.false_loops += result.false_loops;
  sum.false_passed += result.false_passed;
  sum.false_kept += result.false_kept;
  sum.full += result.full;
  sum.warm += result.warm;
  sum.odometry_error_m = std::max(sum.odometry_error_m, result.odometry_error_m);
  sum.error_m = std::max(sum.error_m, result.error_m);
  sum.earth.rms_m = std::max(sum.earth.rms_m, result.earth.rms_m);
  sum.earth.max_m = std::max(sum.earth.max_m, result.earth.max_m);
  if (result.true_loops > 0) {
    row.kept_share_min = std::min(
        row.kept_share_min, static_cast<double>(result.true_kept) / static_cast<double>(result.true_loops));
  }
}

std::string line_of(const char* format, auto... values) {
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

}  // namespace

GraphTable measure_graph(const GraphBenchConfig& config, const std::function<void(double)>& progress) {
  GraphTable table;
  const double steps = static_cast<double>(config.keyframes.size() * kCourses.size() +
                                           kKinds.size() * static_cast<std::size_t>(config.drives));
  double done = 0.0;
  for (const std::size_t keyframes : config.keyframes) {
    for (const NamedCourse& course : kCourses) {
      table.speeds.push_back(measure_size(course, keyframes, config.seed));
      progress(++done / steps);
    }
  }
  for (const Kind& kind : kKinds) {
    GraphCampaignRow row;
    row.name = kind.name;
    for (int k = 0; k < config.drives; ++k) {
      const Course course = kCourses[static_cast<std::size_t>(k) % kCourses.size()].course;
      const auto drive = make_graph(campaign_case(kind, course, config.seed + static_cast<std::uint64_t>(k)));
      add(kind.gates ? pose_graphs::run_back_end(drive) : pose_graphs::run_gnc(drive, kind.gnss), row);
      progress(++done / steps);
    }
    if (row.drives > 0) {
      table.campaigns.push_back(row);
    }
  }
  return table;
}

std::string text_of(const GraphTable& table) {
  std::string text = "CPU ms on one core. iteration, solve: true loops, from the odometry, beside Ceres from the same poses. warm, anew:\n"
                     "the dearest update of a drive with 20 % false loops. full: 20 % false loops and all fixes judged at once\n";
  text += line_of("%-7s %9s %6s %9s %9s %7s %7s %7s %7s %7s %7s %7s\n", "course", "keyframes", "loops", "L", "analysis",
                  "iter", "Ceres/it", "solve", "Ceres/s", "warm", "anew", "full");
  for (const GraphSpeedRow& row : table.speeds) {
    const pose_graphs::SpeedResult& s = row.solver;
    text += line_of("%-7s %9zu %6zu %9zu %9.1f %7.2f %7.2fx %7.1f %6.2fx %7.1f %7.1f %7.1f\n", row.course.c_str(),
                    s.keyframes, s.loops, s.factor_entries, s.analysis_ms, s.iteration_ms,
                    s.ceres_iteration_ms / s.iteration_ms, s.solve_ms, s.ceres_solve_ms / s.solve_ms,
                    row.updates.warm_max_ms, row.updates.full_max_ms, row.full.full_max_ms);
  }
  if (table.campaigns.empty()) {
    return text;
  }
  text += "\nDrives of 1 km, a fifth of the loops false; errors: the worst drive's, m\n";
  text += line_of("%-26s %6s %11s %6s %15s %5s %9s %7s %9s\n", "", "drives", "true kept", "least", "false seen,kept", "anew",
                  "odom rms", "map rms", "earth max");
  for (const GraphCampaignRow& row : table.campaigns) {
    const RunResult& s = row.sum;
    text += line_of("%-26s %6d %5zu/%5zu %5.1f%% %4zu/%4zu,%5zu %5zu %9.2f %7.2f %9.2f\n", row.name.c_str(), row.drives,
                    s.true_kept, s.true_loops, 100.0 * row.kept_share_min, s.false_passed, s.false_loops, s.false_kept,
                    s.full, s.odometry_error_m, s.error_m, s.earth.max_m);
  }
  return text;
}

std::string json_of(const GraphTable& table) {
  nlohmann::json out;
  for (const GraphSpeedRow& row : table.speeds) {
    const pose_graphs::SpeedResult& s = row.solver;
    out["speed"].push_back({{"course", row.course},
                            {"keyframes", s.keyframes},
                            {"loops", s.loops},
                            {"factor_entries", s.factor_entries},
                            {"analysis_ms", s.analysis_ms},
                            {"iteration_ms", s.iteration_ms},
                            {"iterations", s.iterations},
                            {"solve_ms", s.solve_ms},
                            {"ceres_iteration_ms", s.ceres_iteration_ms},
                            {"ceres_iterations", s.ceres_iterations},
                            {"ceres_solve_ms", s.ceres_solve_ms},
                            {"warm_max_ms", row.updates.warm_max_ms},
                            {"anew_max_ms", row.updates.full_max_ms},
                            {"full_ms", row.full.full_max_ms}});
  }
  for (const GraphCampaignRow& row : table.campaigns) {
    const RunResult& s = row.sum;
    out["campaign"].push_back({{"name", row.name},
                               {"drives", row.drives},
                               {"true_loops", s.true_loops},
                               {"true_kept", s.true_kept},
                               {"true_kept_share_min", row.kept_share_min},
                               {"false_loops", s.false_loops},
                               {"false_passed", s.false_passed},
                               {"false_kept", s.false_kept},
                               {"odometry_rms_max_m", s.odometry_error_m},
                               {"map_rms_max_m", s.error_m},
                               {"earth_max_m", s.earth.max_m}});
  }
  return out.dump(2) + "\n";
}

}  // namespace slamd::bench
