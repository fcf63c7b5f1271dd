#include "tools/pose_graphs/graph_runs.hpp"

#include <algorithm>
#include <vector>

#include "core/graph/graduated_non_convexity.hpp"
#include "tools/pose_graphs/ceres_peer.hpp"
#include "tools/pose_graphs/cpu_time.hpp"

namespace slamd::pose_graphs {

namespace {

constexpr int kRepeats = 5;

graph::PoseGraphCapacity capacity_of(const SyntheticGraph& drive) {
  graph::PoseGraphCapacity capacity;
  capacity.keyframes = std::max(capacity.keyframes, drive.T_world_base.size());
  return capacity;
}

double odometry_error(const SyntheticGraph& drive) {
  graph::PoseGraph graph({drive.T_world_base.size(), drive.loops.size(), 1});
  fill(drive, graph, false);
  return position_error(drive, graph);
}

void count_loops(const SyntheticGraph& drive, RunResult& out) {
  for (const SyntheticLoop& loop : drive.loops) {
    ++(loop.is_true ? out.true_loops : out.false_loops);
  }
  out.odometry_error_m = odometry_error(drive);
}

void count_kept(const std::vector<bool>& is_true, const graph::PoseGraph& graph, RunResult& out) {
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    if (graph.loop(k).enabled) {
      ++(is_true[graph.loop(k).id] ? out.true_kept : out.false_kept);
    }
  }
}

void measure_errors(const SyntheticGraph& drive, const graph::PoseGraph& graph, RunResult& out) {
  out.error_m = position_error(drive, graph);
  out.aligned = graph.alignment().has_value();
  if (out.aligned) {
    out.earth = earth_error(drive, graph);
  }
}

}  // namespace

RunResult run_back_end(const SyntheticGraph& drive) {
  graph::BackEndConfig config;
  config.capacity = capacity_of(drive);
  graph::BackEnd back_end(config);
  RunResult out;
  count_loops(drive, out);
  std::vector<bool> is_true;
  std::size_t next = 0;
  for (std::size_t i = 0; i < drive.T_world_base.size(); ++i) {
    const auto id = static_cast<graph::KeyframeId>(i);
    back_end.add_keyframe(id, drive.T_odom_base[i], drive.motion_covariance[i], drive.gravity[i]);
    if (drive.fixes[i]) {
      back_end.add_fix(id, *drive.fixes[i]);
    }
    for (; next < drive.loops.size() && drive.loops[next].candidate.b == id; ++next) {
      graph::LoopId loop = 0;
      back_end.propose(drive.loops[next].candidate, loop);
      is_true.push_back(drive.loops[next].is_true);
    }
    const double begin = cpu_s();
    const graph::Update update = back_end.update();
    const double ms = 1e3 * (cpu_s() - begin);
    double& max_ms = update.kind == graph::UpdateKind::kWarm   ? out.warm_max_ms
                     : update.kind == graph::UpdateKind::kFull ? out.full_max_ms
                                                               : out.other_max_ms;
    max_ms = std::max(max_ms, ms);
    out.warm += update.kind == graph::UpdateKind::kWarm ? 1 : 0;
    out.full += update.kind == graph::UpdateKind::kFull ? 1 : 0;
    for (const graph::LoopEvent& event : update.loops) {
      out.false_passed += event.verdict == graph::LoopVerdict::kAccepted && !is_true[event.id] ? 1 : 0;
    }
  }
  count_kept(is_true, back_end.graph(), out);
  measure_errors(drive, back_end.graph(), out);
  return out;
}

RunResult run_gnc(const SyntheticGraph& drive, bool with_gnss) {
  const graph::PoseGraphCapacity capacity = capacity_of(drive);
  graph::PoseGraph graph(capacity);
  fill(drive, graph, with_gnss);
  if (with_gnss) {
    graph.set_alignment({});
  }
  graph::Optimiser optimiser(graph::PoseGraph::equations_capacity(capacity, 6'000'000));
  graph::GraduatedNonConvexity gnc(capacity, {});
  RunResult out;
  count_loops(drive, out);
  const double begin = cpu_s();
  gnc.run(graph, optimiser, {});
  out.full_max_ms = 1e3 * (cpu_s() - begin);
  out.full = 1;
  out.false_passed = out.false_loops;
  std::vector<bool> is_true;
  for (const SyntheticLoop& loop : drive.loops) {
    is_true.push_back(loop.is_true);
  }
  count_kept(is_true, graph, out);
  measure_errors(drive, graph, out);
  return out;
}

SpeedResult measure_speed(const SyntheticGraph& drive) {
  const graph::PoseGraphCapacity capacity = capacity_of(drive);
  const graph::OptimiserLimits limits;
  graph::PoseGraph graph(capacity);
  fill(drive, graph, false);
  SpeedResult out;
  out.keyframes = graph.size();
  out.loops = graph.loops();
  std::vector<double> analysis;
  std::vector<double> solve;
  graph::Optimiser optimiser(graph::PoseGraph::equations_capacity(capacity, 6'000'000));
  for (int n = 0; n < kRepeats; ++n) {
    graph.set_loop_enabled(0, false);
    graph.set_loop_enabled(0, true);
    double begin = cpu_s();
    optimiser.prepare(graph);
    analysis.push_back(1e3 * (cpu_s() - begin));
    graph.unroll_odometry();
    begin = cpu_s();
    out.iterations = optimiser.run(graph, limits).iterations;
    solve.push_back(1e3 * (cpu_s() - begin));
  }
  std::nth_element(analysis.begin(), analysis.begin() + kRepeats / 2, analysis.end());
  std::nth_element(solve.begin(), solve.begin() + kRepeats / 2, solve.end());
  out.factor_entries = optimiser.equations().factor_entries();
  out.analysis_ms = analysis[kRepeats / 2];
  out.solve_ms = solve[kRepeats / 2];
  out.iteration_ms = out.solve_ms / out.iterations;
  graph.unroll_odometry();
  if (const auto ceres = solve_with_ceres(graph, 100, 1e-6)) {
    out.ceres_iterations = ceres->iterations;
    out.ceres_solve_ms = 1e3 * ceres->cpu_s;
    out.ceres_iteration_ms = out.ceres_solve_ms / ceres->iterations;
  }
  return out;
}

}  // namespace slamd::pose_graphs
