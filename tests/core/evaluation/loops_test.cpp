#include "core/evaluation/loops.hpp"

#include <gtest/gtest.h>

#include "core/geometry/so3.hpp"

namespace slamd::evaluation {
namespace {

using geometry::Se3;

Stamp at(double seconds) { return Stamp(from_seconds(seconds)); }

/// A way of 1 m/s, ten poses a second.
class Way {
 public:
  void go(double heading_rad, double length_m) {
    const Eigen::Matrix3d R = geometry::rotation_from_rpy({0.0, 0.0, heading_rad});
    for (int i = 0; i < static_cast<int>(10.0 * length_m); ++i) {
      p_ += R.col(0) * 0.1;
      seconds_ += 0.1;
      truth.push_back({at(seconds_), Se3(R, p_)});
    }
  }

  Trajectory truth;

 private:
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero();
  double seconds_ = 0.0;
};

/// 100 m east, 50 m round a block, and the first 100 m once more.
Trajectory once_round() {
  Way way;
  way.go(0.0, 100.0);
  way.go(M_PI / 2.0, 30.0);
  way.go(M_PI, 100.0);
  way.go(-M_PI / 2.0, 30.0);
  way.go(0.0, 100.0);
  return way.truth;
}

/// 100 m east, a bow of 60 m, and back on the same road.
Trajectory there_and_back() {
  Way way;
  way.go(0.0, 100.0);
  way.go(M_PI / 2.0, 20.0);
  way.go(0.0, 20.0);
  way.go(-M_PI / 2.0, 20.0);
  way.go(M_PI, 120.0);
  return way.truth;
}

ClaimedLoop loop_of(const Trajectory& truth, double earlier_s, double later_s, const Eigen::Vector3d& error_m = Eigen::Vector3d::Zero()) {
  const Se3 T = truth[static_cast<std::size_t>(10.0 * earlier_s)].T.inverse() * truth[static_cast<std::size_t>(10.0 * later_s)].T;
  return {truth[static_cast<std::size_t>(10.0 * earlier_s)].stamp, truth[static_cast<std::size_t>(10.0 * later_s)].stamp,
          Se3(T.rotation(), T.translation() + error_m)};
}

TEST(Loops, ARoadDrivenTwiceIsRevisitedOverItsLength) {
  const auto sut = revisits_of(once_round(), {});

  ASSERT_FALSE(sut.empty());
  EXPECT_NEAR(to_seconds(sut.front().stamp - at(0.0)), 255.0, 1.5);  // 5 m before the begin
  EXPECT_NEAR(static_cast<double>(sut.size()), 105.0, 3.0);          // a metre apart
  EXPECT_FALSE(sut.front().is_opposite);
}

TEST(Loops, TheWayBackIsOppositeAndNoneForASensorThatLooksAhead) {
  const auto sut = revisits_of(there_and_back(), {});
  const auto ahead = revisits_of(there_and_back(), {.view_rad = 0.7});

  ASSERT_GT(sut.size(), 90U);
  EXPECT_TRUE(sut.back().is_opposite);
  EXPECT_TRUE(ahead.empty());
}

TEST(Loops, ALoopClosesTheRevisitsTwentyMetresAroundIt) {
  const Trajectory truth = once_round();
  const ClaimedLoop loops[] = {loop_of(truth, 50.0, 310.0)};

  const LoopQuality sut = loop_quality_of(truth, loops, {});

  EXPECT_NEAR(static_cast<double>(sut.closed), 41.0, 2.0);
  EXPECT_EQ(sut.wrong, 0U);
  EXPECT_EQ(sut.loops, 1U);
  EXPECT_NEAR(sut.worst_m, 0.0, 1e-9);
}

TEST(Loops, AWrongLoopIsCountedAndClosesNothing) {
  const Trajectory truth = once_round();
  const ClaimedLoop loops[] = {loop_of(truth, 50.0, 310.0, {0.0, 0.4, 0.0}), loop_of(truth, 90.0, 350.0, {0.0, 0.2, 0.0})};

  const LoopQuality sut = loop_quality_of(truth, loops, {});

  EXPECT_EQ(sut.wrong, 1U);
  EXPECT_NEAR(sut.worst_m, 0.4, 1e-9);
  EXPECT_NEAR(static_cast<double>(sut.closed), 30.0, 3.0);  // of the second alone: the way ends 10 m behind it
}

TEST(Loops, LoopsOutsideOfTheTruthAreLeftOut) {
  const Trajectory truth = once_round();
  ClaimedLoop late = loop_of(truth, 50.0, 310.0);
  late.later = truth.back().stamp + std::chrono::seconds(5);

  EXPECT_EQ(loop_quality_of(truth, std::span(&late, 1), {}).loops, 0U);
}

}  // namespace
}  // namespace slamd::evaluation
