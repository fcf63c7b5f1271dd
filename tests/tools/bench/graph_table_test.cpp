#include "tools/bench/graph_table.hpp"

#include <gtest/gtest.h>

namespace slamd::bench {
namespace {

TEST(GraphTable, HasARowForEachCourseAndCampaign) {
  GraphBenchConfig sut;
  sut.keyframes = {300};
  sut.drives = 1;
  double progress = 0.0;

  const GraphTable table = measure_graph(sut, [&](double share) { progress = share; });

  EXPECT_EQ(progress, 1.0);
  ASSERT_EQ(table.speeds.size(), 3U);
  for (const GraphSpeedRow& row : table.speeds) {
    EXPECT_EQ(row.solver.keyframes, 300U);
    EXPECT_GT(row.solver.iteration_ms, 0.0);
    EXPECT_GT(row.full.full_max_ms, 0.0);
    EXPECT_NE(text_of(table).find(row.course), std::string::npos);
  }
  ASSERT_EQ(table.campaigns.size(), 5U);
  for (const GraphCampaignRow& row : table.campaigns) {
    EXPECT_EQ(row.sum.false_kept, 0U) << row.name;
    EXPECT_NE(json_of(table).find(row.name), std::string::npos);
  }
}

}  // namespace
}  // namespace slamd::bench
