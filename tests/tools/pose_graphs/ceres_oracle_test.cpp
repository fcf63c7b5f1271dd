#include <gtest/gtest.h>

#include "core/graph/optimiser.hpp"
#include "tools/pose_graphs/ceres_peer.hpp"
#include "tools/pose_graphs/synthetic_graph.hpp"

namespace slamd::pose_graphs {
namespace {

/// The distance between two graphs' poses and alignments: the greatest of an axis. Units: m and rad.
double distance(const graph::PoseGraph& a, const graph::PoseGraph& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    out = std::max(out, boxminus(a.node(i).T_map_base, b.node(i).T_map_base).cwiseAbs().maxCoeff());
  }
  if (a.alignment()) {
    out = std::max(out, (a.alignment()->p_map_enu - b.alignment()->p_map_enu).cwiseAbs().maxCoeff());
    out = std::max(out, std::abs(a.alignment()->yaw_rad - b.alignment()->yaw_rad));
  }
  return out;
}

/// All kinds of factors, with weights between 0 and 1, and information that is not diagonal.
void make(const SyntheticConfig& config, graph::PoseGraph& graph) {
  const SyntheticGraph synthetic = make_graph(config);
  fill(synthetic, graph, config.gnss);
  for (std::size_t k = 0; k < graph.loops(); ++k) {
    graph.set_loop_weight(k, k % 3 == 0 ? 0.3 : 1.0);
  }
  for (std::size_t i = 0; i < graph.size(); ++i) {
    graph.set_fix_weight(i, i % 4 == 0 ? 0.5 : 1.0);
  }
  graph::PriorFactor prior{synthetic.T_world_base[100], geometry::Matrix6d::Constant(20.0)};
  prior.information.diagonal().array() += 400.0;
  ASSERT_TRUE(graph.add_prior(100, prior));
  if (config.gnss) {
    graph.set_alignment({synthetic.T_world_enu.yaw_rad + 0.2, synthetic.T_world_enu.p_map_enu + Eigen::Vector3d(8.0, 5.0, 1.0)});
  }
}

void agrees_with_ceres(const SyntheticConfig& config) {
  graph::PoseGraphCapacity capacity;
  capacity.keyframes = config.keyframes;
  graph::PoseGraph ours(capacity);
  make(config, ours);
  graph::PoseGraph oracle = ours;
  graph::Optimiser sut(graph::PoseGraph::equations_capacity(capacity, 3'000'000));

  const graph::OptimiserResult found = sut.run(ours, {100, 1e-9, 1e-10});
  const auto expected = solve_with_ceres(oracle, 200, 1e-16);

  if (!expected) {
    GTEST_SKIP() << "built without Ceres (libceres-dev): no oracle";
  }
  EXPECT_EQ(found.end, graph::OptimiserEnd::kConverged);
  EXPECT_LT(distance(ours, oracle), 1e-6);
  EXPECT_NEAR(found.cost, expected->cost, 1e-6 * expected->cost);
}

TEST(OptimiserAgainstCeres, HasTheSameOptimumWithAllFactors) {
  SyntheticConfig config;
  config.keyframes = 400;
  config.loops = 80;
  config.gnss = true;

  agrees_with_ceres(config);
}

TEST(OptimiserAgainstCeres, HasTheSameOptimumOnASphere) {
  SyntheticConfig config;
  config.course = Course::kSphere;
  config.keyframes = 600;
  config.loops = 400;
  config.errors.step_yaw_rad = 0.01;
  config.errors.step_tilt_rad = 0.01;

  agrees_with_ceres(config);
}

}  // namespace
}  // namespace slamd::pose_graphs
