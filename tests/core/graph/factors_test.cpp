#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <functional>

#include "core/graph/between_factor.hpp"
#include "core/graph/gnss_factor.hpp"
#include "core/graph/gravity_factor.hpp"
#include "core/graph/prior_factor.hpp"
#include "random_poses.hpp"

namespace slamd::graph {
namespace {

using geometry::Se3;
using geometry::Vector6d;

constexpr double kStep = 1e-6;
constexpr double kTolerance = 1e-7;  // of central differences at this step

/// Central differences of a residual by a perturbation of kColumns numbers.
template <int kRows, int kColumns>
Eigen::Matrix<double, kRows, kColumns> numeric(
    const std::function<Eigen::Matrix<double, kRows, 1>(const Eigen::Matrix<double, kColumns, 1>&)>& residual) {
  Eigen::Matrix<double, kRows, kColumns> J;
  for (int k = 0; k < kColumns; ++k) {
    Eigen::Matrix<double, kColumns, 1> delta = Eigen::Matrix<double, kColumns, 1>::Zero();
    delta[k] = kStep;
    J.col(k) = (residual(delta) - residual(-delta)) / (2.0 * kStep);
  }
  return J;
}

/// Whether two matrices agree, each entry against its own size.
template <typename A, typename B>
bool agree(const A& a, const B& b) {
  return ((a - b).cwiseAbs().array() <= kTolerance * (1.0 + b.cwiseAbs().array())).all();
}

void check(const std::function<bool(Draw&)>& property) {
  EXPECT_TRUE(rc::check([&] {
    Draw draw(*rc::gen::arbitrary<std::uint64_t>());
    RC_ASSERT(property(draw));
  }));
}

TEST(BetweenFactor, HasTheJacobiansOfItsResidual) {
  check([](Draw& draw) {
    const Se3 T_map_a = draw.pose(20.0, 1.0);
    const Se3 T_map_b = draw.pose(20.0, 1.0);
    const BetweenFactor sut{boxplus(T_map_a.inverse() * T_map_b, draw.pose(1.0, 0.3).translation().replicate<2, 1>()), {}};

    const BetweenLinearised at = linearise(sut, T_map_a, T_map_b);

    return agree(at.J_a, numeric<6, 6>([&](const Vector6d& d) { return residual_of(sut, boxplus(T_map_a, d), T_map_b); })) &&
           agree(at.J_b, numeric<6, 6>([&](const Vector6d& d) { return residual_of(sut, T_map_a, boxplus(T_map_b, d)); })) &&
           at.residual == residual_of(sut, T_map_a, T_map_b);
  });
}

TEST(BetweenFactor, MeasuresItsErrorInTheAxesOfTheFirstPose) {
  const Se3 T_map_a(geometry::so3_exp({0.0, 0.0, M_PI_2}), {5.0, 0.0, 0.0});
  const Se3 T_a_b(geometry::so3_exp({0.0, 0.0, 1.0}), {2.0, 0.0, 0.0});
  const BetweenFactor sut{T_a_b, {}};

  const Vector6d r = residual_of(sut, T_map_a, T_map_a * Se3(T_a_b.rotation(), {2.5, 0.0, 0.0}));

  EXPECT_LT((r - (Vector6d() << 0.5, 0.0, 0.0, 0.0, 0.0, 0.0).finished()).norm(), 1e-12);
}

TEST(GnssFactor, HasTheJacobiansOfItsResidual) {
  check([](Draw& draw) {
    const Se3 T_map_base = draw.pose(50.0, 1.0);
    const GnssAlignment alignment{draw.uniform(-M_PI, M_PI), draw.vector(30.0)};
    const GnssFactor sut{draw.vector(50.0), draw.vector(1.0), 2.0, 4.0};

    const GnssLinearised at = linearise(sut, T_map_base, alignment);

    return agree(at.J_pose,
                 numeric<3, 6>([&](const Vector6d& d) { return residual_of(sut, boxplus(T_map_base, d), alignment); })) &&
           agree(at.J_alignment,
                 numeric<3, 4>([&](const Vector4d& d) { return residual_of(sut, T_map_base, boxplus(alignment, d)); }));
  });
}

TEST(GnssFactor, IsZeroWhereTheAntennaIsNotTheBase) {
  const Se3 T_map_base(geometry::so3_exp({0.0, 0.0, M_PI_2}), {10.0, 0.0, 0.0});
  const GnssAlignment north_is_x{-M_PI_2, Eigen::Vector3d::Zero()};  // x of the map is north, −y is east
  const GnssFactor sut{{-0.4, 10.0, 1.0}, {0.4, 0.0, 1.0}, 1.0, 1.0};

  EXPECT_LT(residual_of(sut, T_map_base, north_is_x).norm(), 1e-12);
}

TEST(GravityFactor, HasTheJacobianOfItsResidual) {
  check([](Draw& draw) {
    const Se3 T_map_base = draw.pose(1.0, 1.0);
    const GravityFactor sut{(T_map_base.rotation().row(2).transpose() + draw.vector(0.2)).normalized(), 0.01};

    const GravityLinearised at = linearise(sut, T_map_base);
    const auto J = numeric<2, 6>([&](const Vector6d& d) { return residual_of(sut, boxplus(T_map_base, d)); });

    return agree(at.J_rotation, J.rightCols<3>()) && J.leftCols<3>().norm() < 1e-9;
  });
}

TEST(GravityFactor, IsAsLargeAsTheTiltAndBlindToYaw) {
  const GravityFactor sut{Eigen::Vector3d::UnitZ(), 0.01};

  EXPECT_NEAR(residual_of(sut, {geometry::so3_exp({0.02, 0.0, 0.0}), Eigen::Vector3d::Zero()}).norm(), std::sin(0.02), 1e-12);
  EXPECT_NEAR(residual_of(sut, {geometry::so3_exp({0.0, 0.0, 1.0}), Eigen::Vector3d::Zero()}).norm(), 0.0, 1e-12);
}

TEST(PriorFactor, HasTheJacobianOfItsResidual) {
  check([](Draw& draw) {
    const Se3 T_map_base = draw.pose(20.0, 1.0);
    const PriorFactor sut{boxplus(T_map_base, draw.vector(0.4).replicate<2, 1>()), {}};

    const PriorLinearised at = linearise(sut, T_map_base);

    return agree(at.J_pose, numeric<6, 6>([&](const Vector6d& d) { return residual_of(sut, boxplus(T_map_base, d)); }));
  });
}

TEST(PriorFactor, AsAnAnchorHoldsPlaceAndYawAndLeavesTheTilt) {
  const geometry::Matrix6d information = anchor_information();

  EXPECT_GT(information.diagonal().head<3>().minCoeff(), 1e5);
  EXPECT_EQ(information(3, 3), 0.0);
  EXPECT_EQ(information(4, 4), 0.0);
  EXPECT_GT(information(5, 5), 1e8);
}

}  // namespace
}  // namespace slamd::graph
