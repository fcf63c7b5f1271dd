#include <gtest/gtest.h>

#include <tuple>

#include "tools/pose_graphs/graph_runs.hpp"
#include "tools/pose_graphs/synthetic_graph.hpp"

namespace slamd::pose_graphs {
namespace {

constexpr std::uint64_t kSeeds[] = {101, 102, 103};  // the thresholds were set with others
constexpr Course kCourses[] = {Course::kGrid, Course::kSphere, Course::kTown};

/// A fifth of the loops is false: half of them between places that look alike, half of them in runs that agree.
SyntheticConfig with_false_loops(Course course, std::uint64_t seed, double step_yaw_rad) {
  SyntheticConfig config;
  config.course = course;
  config.keyframes = 800;
  config.loops = 80;
  config.false_share = 0.2;
  config.false_near = 0.5;
  config.false_runs = 0.5;
  config.errors.step_yaw_rad = step_yaw_rad;
  config.seed = seed;
  return config;
}

void keeps_the_true_and_none_of_the_false(const RunResult& result) {
  EXPECT_EQ(result.false_loops, result.true_loops / 4);
  EXPECT_EQ(result.false_kept, 0U);
  EXPECT_GE(static_cast<double>(result.true_kept), 0.95 * static_cast<double>(result.true_loops));
}

TEST(LoopCampaign, KeepsTrueLoopsAndNoneOfTheFalseAsTheyCome) {
  for (const Course course : kCourses) {
    for (const std::uint64_t seed : kSeeds) {
      SCOPED_TRACE(std::to_string(static_cast<int>(course)) + " seed " + std::to_string(seed));
      const RunResult result = run_back_end(make_graph(with_false_loops(course, seed, 0.0005)));

      keeps_the_true_and_none_of_the_false(result);
      EXPECT_LT(result.error_m, result.odometry_error_m);
    }
  }
}

TEST(LoopCampaign, KeepsTrueLoopsAndNoneOfTheFalseByGncAlone) {
  for (const Course course : kCourses) {
    for (const std::uint64_t seed : kSeeds) {
      SCOPED_TRACE(std::to_string(static_cast<int>(course)) + " seed " + std::to_string(seed));

      keeps_the_true_and_none_of_the_false(run_gnc(make_graph(with_false_loops(course, seed, 0.0015)), false));
    }
  }
}

TEST(GnssCampaign, HoldsTheMapToAMetreThroughAnOutageAndJumps) {
  for (const Course course : {Course::kGrid, Course::kTown}) {
    for (const std::uint64_t seed : kSeeds) {
      SCOPED_TRACE(std::to_string(static_cast<int>(course)) + " seed " + std::to_string(seed));
      SyntheticConfig config;
      config.course = course;
      config.keyframes = 800;
      config.loops = 0;
      config.gnss = true;
      config.gnss_outage_s = 60.0;
      config.gnss_jump_m = 15.0;
      config.seed = seed;

      const RunResult result = run_back_end(make_graph(config));

      ASSERT_TRUE(result.aligned);
      EXPECT_LE(result.earth.max_m, 1.0);
    }
  }
}

}  // namespace
}  // namespace slamd::pose_graphs
