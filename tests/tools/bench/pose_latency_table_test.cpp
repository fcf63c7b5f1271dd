#include "tools/bench/pose_latency_table.hpp"

#include <gtest/gtest.h>

namespace slamd::bench {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

std::vector<Moment> samples(int count) {
  std::vector<Moment> moments;
  for (int i = 0; i < count; ++i) {
    moments.push_back({Stamp{} + milliseconds(i), milliseconds(100 + i)});
  }
  return moments;
}

TEST(PoseLatencyTable, TakesEachPosesTimeFromItsOwnSample) {
  const std::vector<Moment> sent = samples(1000);
  std::vector<Moment> heard = sent;
  for (std::size_t i = 0; i < heard.size(); ++i) {
    heard[i].instant += microseconds(i < 990 ? 50 : 4000);
  }

  const PoseLatencyRow sut = row_of(sent, heard);

  EXPECT_EQ(sut.p50, microseconds(50));
  EXPECT_EQ(sut.p99, microseconds(50));
  EXPECT_EQ(sut.p999, microseconds(4000));
  EXPECT_EQ(sut.max, microseconds(4000));
  EXPECT_EQ(sut.delivered(), 1.0);
}

TEST(PoseLatencyTable, CountsWhatIsMissingSinceTheFirstPoseAndNothingTwice) {
  const std::vector<Moment> sent = samples(100);
  const std::vector<Moment> heard = {sent[60], sent[61], sent[61], sent[99], {Stamp{} + microseconds(70500), milliseconds(180)}};

  const PoseLatencyRow sut = row_of(sent, heard);

  EXPECT_EQ(sut.sent, 40U);
  EXPECT_EQ(sut.heard, 3U);
}

TEST(PoseLatencyTable, IsEmptyWithoutPoses) {
  const PoseLatencyRow sut = row_of(samples(10), {});

  EXPECT_EQ(sut.heard, 0U);
  EXPECT_EQ(sut.delivered(), 0.0);
}

}  // namespace
}  // namespace slamd::bench
