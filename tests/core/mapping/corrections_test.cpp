#include "core/mapping/corrections.hpp"

#include <gtest/gtest.h>

namespace slamd::mapping {
namespace {

using geometry::Se3;

Se3 at(double x, double y) { return {Eigen::Matrix3d::Identity(), {x, y, 0.0}}; }

Stamp second(double s) { return Stamp{} + from_seconds(s); }

TEST(CorrectedPath, LeavesPosesWhereThereAreNoKeyframes) {
  const CorrectedPath sut({});

  EXPECT_EQ(sut.T_map_base(second(1.0), at(1.0, 2.0)).translation(), Eigen::Vector3d(1.0, 2.0, 0.0));
}

TEST(CorrectedPath, ChangesTheCorrectionEvenlyBetweenKeyframes) {
  const CorrectedPath sut({{second(1.0), at(0.0, 0.0), at(0.0, 1.0)}, {second(3.0), at(4.0, 0.0), at(4.0, 2.0)}});

  EXPECT_TRUE(sut.T_map_base(second(1.0), at(0.0, 0.0)).translation().isApprox(Eigen::Vector3d(0.0, 1.0, 0.0), 1e-12));
  EXPECT_TRUE(sut.T_map_base(second(1.5), at(1.0, 0.0)).translation().isApprox(Eigen::Vector3d(1.0, 1.25, 0.0), 1e-12));
  EXPECT_TRUE(sut.T_map_base(second(3.0), at(4.0, 0.0)).translation().isApprox(Eigen::Vector3d(4.0, 2.0, 0.0), 1e-12));
}

TEST(CorrectedPath, GoesOnFromTheOutermostKeyframes) {
  const CorrectedPath sut({{second(1.0), at(0.0, 0.0), at(0.0, 1.0)}, {second(3.0), at(4.0, 0.0), at(4.0, 2.0)}});

  EXPECT_TRUE(sut.T_map_base(second(0.0), at(-2.0, 0.0)).translation().isApprox(Eigen::Vector3d(-2.0, 1.0, 0.0), 1e-12));
  EXPECT_TRUE(sut.T_map_base(second(9.0), at(7.0, 0.0)).translation().isApprox(Eigen::Vector3d(7.0, 2.0, 0.0), 1e-12));
}

}  // namespace
}  // namespace slamd::mapping
