#include <gtest/gtest.h>

#include <initializer_list>

#include "core/evaluation/trajectory.hpp"

namespace slamd::evaluation {
namespace {

using std::chrono::milliseconds;

/// Poses at these times [ms], each as far along x [m] as its time [s].
Trajectory at(std::initializer_list<int> times_ms) {
  Trajectory trajectory;
  for (const int t : times_ms) {
    trajectory.push_back(
        {Stamp{} + milliseconds(t), {Eigen::Matrix3d::Identity(), {1e-3 * t, 0.0, 0.0}}});
  }
  return trajectory;
}

double x_of(const geometry::Se3& T) {
  return T.translation().x();
}

TEST(AssociateInterpolated, PutsTheReferenceAtTheEstimatesStamps) {
  const auto sut =
      associate_interpolated(at({0, 100, 200}), at({0, 30, 150, 200}), milliseconds(100));

  ASSERT_EQ(sut.size(), 4U);
  for (const PosePair& pair : sut) {
    EXPECT_NEAR(x_of(pair.reference), x_of(pair.estimate), 1e-12);
  }
}

TEST(AssociateInterpolated, LeavesOutWhatIsOutsideTheReference) {
  const auto sut =
      associate_interpolated(at({100, 200}), at({50, 99, 150, 201}), milliseconds(100));

  ASSERT_EQ(sut.size(), 1U);
  EXPECT_EQ(sut[0].stamp, Stamp{} + milliseconds(150));
}

TEST(AssociateInterpolated, DoesNotBridgeLongGaps) {
  const auto sut =
      associate_interpolated(at({0, 100, 400, 500}), at({50, 250, 450}), milliseconds(100));

  ASSERT_EQ(sut.size(), 2U);
  EXPECT_EQ(sut[1].stamp, Stamp{} + milliseconds(450));
}

TEST(AssociateInterpolated, TakesAReferencePoseInsideALongGapsEdge) {
  EXPECT_EQ(associate_interpolated(at({0, 1000}), at({0, 1000}), milliseconds(1)).size(), 2U);
}

TEST(AssociateNearest, GoesByTheStampsOfTheShorter) {
  const auto sut = associate_nearest(at({0, 10, 20, 30, 40}), at({1, 21}), milliseconds(10));

  ASSERT_EQ(sut.size(), 2U);
  EXPECT_DOUBLE_EQ(x_of(sut[0].reference), 0.0);
  EXPECT_DOUBLE_EQ(x_of(sut[1].reference), 0.02);
}

TEST(AssociateNearest, KeepsRolesWhenTheEstimateIsLonger) {
  const auto sut = associate_nearest(at({1, 21}), at({0, 10, 20, 30, 40}), milliseconds(10));

  ASSERT_EQ(sut.size(), 2U);
  EXPECT_DOUBLE_EQ(x_of(sut[1].reference), 0.021);
  EXPECT_DOUBLE_EQ(x_of(sut[1].estimate), 0.02);
}

TEST(AssociateNearest, TakesTheLimitItselfIn) {
  EXPECT_EQ(associate_nearest(at({0, 100, 200}), at({10}), milliseconds(10)).size(), 1U);
  EXPECT_EQ(associate_nearest(at({0, 100, 200}), at({11}), milliseconds(10)).size(), 0U);
}

TEST(AssociateNearest, MayUseAStampTwice) {
  const auto sut = associate_nearest(at({0, 100, 200}), at({98, 102}), milliseconds(10));

  ASSERT_EQ(sut.size(), 2U);
  EXPECT_DOUBLE_EQ(x_of(sut[0].reference), 0.1);
  EXPECT_DOUBLE_EQ(x_of(sut[1].reference), 0.1);
}

TEST(AssociateNearest, TreatsTheReferenceAsTheLongerOneAtEqualLengths) {
  // By the estimate's stamps both find 0; by the reference's, 50 would find none.
  const auto sut = associate_nearest(at({0, 50}), at({2, 8}), milliseconds(10));

  ASSERT_EQ(sut.size(), 2U);
  EXPECT_DOUBLE_EQ(x_of(sut[0].reference), 0.0);
  EXPECT_DOUBLE_EQ(x_of(sut[1].reference), 0.0);
}

TEST(AssociateNearest, TakesTheEarlierOfTwoEquallyNear) {
  const auto sut = associate_nearest(at({0, 10, 20}), at({5}), milliseconds(10));

  ASSERT_EQ(sut.size(), 1U);
  EXPECT_DOUBLE_EQ(x_of(sut[0].reference), 0.0);
}

TEST(AssociateNearest, FindsNothingInNothing) {
  EXPECT_TRUE(associate_nearest({}, at({1}), milliseconds(10)).empty());
  EXPECT_TRUE(associate_nearest(at({1}), {}, milliseconds(10)).empty());
}

TEST(PathLength, SumsSteps) {
  EXPECT_NEAR(path_length_m(at({0, 1000, 500})), 1.5, 1e-12);
  EXPECT_EQ(path_length_m({}), 0.0);
}

}  // namespace
}  // namespace slamd::evaluation
