#include "core/graph/optimiser.hpp"

#include <gtest/gtest.h>

#include "random_poses.hpp"

namespace slamd::graph {
namespace {

using geometry::Se3;

constexpr std::size_t kKeyframes = 60;
constexpr PoseGraphCapacity kCapacity{kKeyframes, 100, 4};

/// A graph whose factors all agree, so that its least sum is zero and its optimum the truth.
PoseGraph exact_graph(Draw& draw, std::vector<Se3>& truth) {
  PoseGraph graph(kCapacity);
  truth.assign(1, Se3());
  for (std::size_t i = 1; i < kKeyframes; ++i) {
    truth.push_back(truth.back() * draw.pose(1.0, 0.3));
  }
  for (std::size_t i = 0; i < kKeyframes; ++i) {
    const Se3 T_previous_this = i == 0 ? Se3() : truth[i - 1].inverse() * truth[i];
    graph.add_keyframe(static_cast<KeyframeId>(i), truth[i], {T_previous_this, draw.positive<6>(100.0)});
    graph.set_gravity(i, {truth[i].rotation().row(2).transpose(), 0.01});
  }
  graph.add_prior(0, {Se3(), anchor_information()});
  for (std::size_t k = 0; k < 20; ++k) {
    const auto a = static_cast<KeyframeId>(draw.uniform(0.0, 30.0));
    const auto b = static_cast<KeyframeId>(draw.uniform(31.0, 60.0));
    graph.add_loop({static_cast<LoopId>(k), a, b, {truth[a].inverse() * truth[b], draw.positive<6>(100.0)}, 1.0, true});
  }
  return graph;
}

double distance(const PoseGraph& graph, const std::vector<Se3>& truth) {
  double out = 0.0;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    out = std::max(out, boxminus(graph.node(i).T_map_base, truth[i]).norm());
  }
  return out;
}

TEST(Optimiser, FindsThePosesThatAllFactorsAgreeOn) {
  Draw draw(1);
  std::vector<Se3> truth;
  PoseGraph graph = exact_graph(draw, truth);
  for (std::size_t i = 0; i < kKeyframes; ++i) {
    graph.set_pose(i, truth[i] * draw.pose(0.3, 0.1));
  }
  Optimiser sut(PoseGraph::equations_capacity(kCapacity, 100'000));

  const OptimiserResult result = sut.run(graph, {30, 1e-9, 1e-9});

  EXPECT_EQ(result.end, OptimiserEnd::kConverged);
  EXPECT_LT(distance(graph, truth), 1e-8);
}

TEST(Optimiser, NeverRaisesTheSumFromWildBeginnings) {
  Draw draw(2);
  Optimiser sut(PoseGraph::equations_capacity(kCapacity, 100'000));
  for (int n = 0; n < 10; ++n) {
    std::vector<Se3> truth;
    PoseGraph graph = exact_graph(draw, truth);
    for (std::size_t i = 0; i < kKeyframes; ++i) {
      graph.set_pose(i, truth[i] * draw.pose(5.0, 0.8));
    }
    double last = graph.cost();
    for (int k = 0; k < 30; ++k) {
      const OptimiserResult result = sut.run(graph, {3, 1e-9, 1e-9});
      ASSERT_LE(result.cost, last * (1.0 + 1e-9));
      ASSERT_NEAR(result.cost, graph.cost(), 1e-9 * (1.0 + result.cost));
      last = result.cost;
    }
  }
}

TEST(Optimiser, LeavesOutALoopThatIsNotEnabled) {
  Draw draw(3);
  std::vector<Se3> truth;
  PoseGraph graph = exact_graph(draw, truth);
  graph.add_loop({99, 3, 50, {draw.pose(20.0, 1.0), 1e6 * geometry::Matrix6d::Identity()}, 1.0, false});
  Optimiser sut(PoseGraph::equations_capacity(kCapacity, 100'000));

  sut.run(graph, {30, 1e-9, 1e-9});

  EXPECT_LT(distance(graph, truth), 1e-8);
}

TEST(Optimiser, SaysThatTheFactorDoesNotFitAndMovesNothing) {
  Draw draw(4);
  std::vector<Se3> truth;
  PoseGraph graph = exact_graph(draw, truth);
  graph.set_pose(7, truth[7] * draw.pose(0.3, 0.1));
  const Se3 before = graph.node(7).T_map_base;
  Optimiser sut(PoseGraph::equations_capacity(kCapacity, 1'000));

  EXPECT_EQ(sut.run(graph, {}).end, OptimiserEnd::kFactorTooLarge);
  EXPECT_EQ(boxminus(graph.node(7).T_map_base, before).norm(), 0.0);
}

TEST(PoseGraph, RefusesLoopsAndPriorsBeyondItsLimits) {
  Draw draw(5);
  std::vector<Se3> truth;
  PoseGraph sut = exact_graph(draw, truth);
  for (LoopId id = 20; id < 100; ++id) {
    EXPECT_TRUE(sut.add_loop({id, 1, 40, {}, 1.0, true}));
  }

  EXPECT_FALSE(sut.add_loop({100, 1, 40, {}, 1.0, true}));
  sut.remove_loop(50);
  EXPECT_TRUE(sut.add_loop({100, 1, 40, {}, 1.0, true}));
  EXPECT_TRUE(sut.add_prior(1, {}) && sut.add_prior(1, {}) && sut.add_prior(1, {}));
  EXPECT_FALSE(sut.add_prior(1, {}));
}

TEST(PoseGraph, KeepsTheMoreCertainOfTwoFixes) {
  Draw draw(6);
  std::vector<Se3> truth;
  PoseGraph sut = exact_graph(draw, truth);

  sut.set_fix(3, {Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero(), 2.0, 4.0});
  sut.set_fix(3, {Eigen::Vector3d::UnitY(), Eigen::Vector3d::Zero(), 1.0, 2.0});
  sut.set_fix(3, {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero(), 3.0, 6.0});

  EXPECT_EQ(sut.node(3).fix->p_enu, Eigen::Vector3d::UnitY());
  EXPECT_EQ(sut.fixes(), 1U);
}

TEST(PoseGraph, PutsBackWhatItSaved) {
  Draw draw(7);
  std::vector<Se3> truth;
  PoseGraph sut = exact_graph(draw, truth);
  GraphState state(kCapacity);
  sut.save(state);
  const std::uint64_t version = sut.structure_version();

  sut.set_pose(5, draw.pose(9.0, 1.0));
  sut.set_loop_weight(2, 0.0);
  sut.set_loop_enabled(2, false);
  sut.put_back(state);

  EXPECT_LT(distance(sut, truth), 1e-12);
  EXPECT_TRUE(sut.loop(2).enabled);
  EXPECT_EQ(sut.loop(2).weight, 1.0);
  EXPECT_GT(sut.structure_version(), version);
}

}  // namespace
}  // namespace slamd::graph
