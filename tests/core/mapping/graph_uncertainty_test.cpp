#include "core/mapping/graph_uncertainty.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace slamd::mapping {
namespace {

using geometry::Matrix6d;
using geometry::Se3;

/// A square of 4 × 10 keyframes, a metre apart, that ends where it began.
struct GraphUncertaintyTest : testing::Test {
  static graph::BackEndConfig config() {
    graph::BackEndConfig config;
    config.capacity = {64, 16, 4};
    config.factor_entries = 50'000;
    config.supporters = 0;
    return config;
  }

  GraphUncertaintyTest() : back_end(config()) {
    Matrix6d step = Matrix6d::Zero();
    step.diagonal() << 1e-4, 1e-4, 1e-6, 1e-8, 1e-8, 1e-6;
    for (int i = 0; i < 40; ++i) {
      back_end.add_keyframe(static_cast<graph::KeyframeId>(i), pose(i), step, std::nullopt);
    }
  }

  static Se3 pose(int i) {
    static constexpr double kYaw[] = {0.0, M_PI_2, M_PI, -M_PI_2};
    static const Eigen::Vector3d kCorners[] = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
    const Eigen::Matrix3d R = Eigen::AngleAxisd(kYaw[i / 10], Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return {R, kCorners[i / 10] + R * Eigen::Vector3d(i % 10, 0.0, 0.0)};
  }

  graph::BackEnd back_end;
  GraphUncertainty sut{64, 16};
};

TEST_F(GraphUncertaintyTest, IsThatOfTheOdometryWhereThereAreNoLoops) {
  sut.look_from(back_end, 39);

  EXPECT_EQ(sut.position_std_m(39), 0.0);
  EXPECT_GT(sut.position_std_m(30), sut.position_std_m(35));
  EXPECT_NEAR(sut.yaw_std_rad(30), std::sqrt(9 * 1e-6), 1e-5);
  const Matrix6d twist = back_end.chain().spread(0, 39);
  const Eigen::Matrix2d P = twist.topLeftCorner<2, 2>();
  EXPECT_NEAR(sut.position_std_m(0), std::sqrt(P.trace()), 1e-3) << "as a twist at the first keyframe, which stands at map's origin";
}

TEST_F(GraphUncertaintyTest, IsSmallAcrossALoop) {
  sut.look_from(back_end, 39);
  const double before_m = sut.position_std_m(0);
  Matrix6d covariance = Matrix6d::Identity() * 1e-6;
  graph::LoopId id = 0;
  ASSERT_EQ(back_end.propose({0, 39, {pose(0).inverse() * pose(39), covariance}, true}, id), graph::Proposal::kPending);
  ASSERT_EQ(back_end.update().kind, graph::UpdateKind::kWarm);

  sut.look_from(back_end, 39);

  EXPECT_GT(before_m, 0.06);
  EXPECT_LT(sut.position_std_m(0), 0.005);
  EXPECT_LT(sut.position_std_m(1), 0.02);
  EXPECT_GT(sut.position_std_m(20), 0.03);
}

}  // namespace
}  // namespace slamd::mapping
