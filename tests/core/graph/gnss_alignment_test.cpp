#include "core/graph/gnss_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "random_poses.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::graph {
namespace {

const GnssAlignment kTruth{2.5, {100.0, -40.0, 3.0}};

/// Fixes along a bend, every metre.
std::vector<AlignedPair> pairs(Draw& draw, std::size_t count, double noise_m) {
  std::vector<AlignedPair> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = static_cast<double>(i);
    const Eigen::Vector3d p_map(30.0 * std::sin(s / 30.0), 30.0 * (1.0 - std::cos(s / 30.0)), 0.0);
    out.push_back({p_map, kTruth.inverse_times(p_map) + draw.vector(noise_m), noise_m, noise_m});
  }
  return out;
}

double yaw_error(const GnssAlignment& found) { return std::abs(std::remainder(found.yaw_rad - kTruth.yaw_rad, 2.0 * M_PI)); }

TEST(GnssAlignment, IsFoundFromMotionWithAnErrorAsSaid) {
  Draw draw(1);
  double squares = 0.0;
  double said = 0.0;
  constexpr int kDraws = 300;
  for (int n = 0; n < kDraws; ++n) {
    const std::vector<AlignedPair> sut = pairs(draw, 60, 0.5);
    std::vector<double> weights(sut.size());
    const AlignmentEstimate found = fit_alignment(sut, weights);
    squares += yaw_error(found.alignment) * yaw_error(found.alignment) / kDraws;
    said += found.yaw_std_rad / kDraws;
  }

  EXPECT_NEAR(std::sqrt(squares) / said, 1.0, 0.15);
}

TEST(GnssAlignment, LeavesOutWhatJumps) {
  Draw draw(2);
  std::vector<AlignedPair> sut = pairs(draw, 80, 0.5);
  for (std::size_t i = 20; i < 40; ++i) {
    sut[i].p_enu += Eigen::Vector3d(15.0, 0.0, 0.0);
  }
  std::vector<double> weights(sut.size());

  const AlignmentEstimate found = fit_alignment(sut, weights);

  EXPECT_LT(yaw_error(found.alignment), 4.0 * found.yaw_std_rad);
  for (std::size_t i = 20; i < 40; ++i) {
    EXPECT_EQ(weights[i], 0.0);
  }
}

TEST(GnssAlignment, KnowsNoYawAtRest) {
  Draw draw(3);
  std::vector<AlignedPair> sut = pairs(draw, 50, 1.0);
  for (AlignedPair& pair : sut) {
    pair.p_enu += kTruth.inverse_times(sut[0].p_map) - kTruth.inverse_times(pair.p_map);
    pair.p_map = Eigen::Vector3d::Zero();
  }
  std::vector<double> weights(sut.size());

  const AlignmentEstimate found = fit_alignment(sut, weights);

  EXPECT_GT(found.yaw_std_rad, 1.0);
  EXPECT_EQ(found.extent_m, 0.0);
}

TEST(GnssAlignment, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Draw draw(4);
  const std::vector<AlignedPair> sut = pairs(draw, 80, 2.0);
  std::vector<double> weights(sut.size());

  EXPECT_EQ(support::count_allocations([&] { fit_alignment(sut, weights); }), 0U);
}

}  // namespace
}  // namespace slamd::graph
