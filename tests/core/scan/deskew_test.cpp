#include "core/scan/deskew.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/geometry/so3.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::scan {
namespace {

using geometry::Se3;
using sensor::ImuSample;

/// A vehicle in a tight bend on a slope: constant body rates and forces, so that the motion is exactly known.
struct Bend {
  Eigen::Vector3d rate_radps{0.3, -0.2, 2.0};
  double speed_mps = 3.0;

  Se3 T_odom_imu(double t_s) const {
    const Eigen::Matrix3d R = geometry::so3_exp(rate_radps * t_s);
    return {R, integrate(t_s)};
  }

  /// ∫ R(t) v dt with v along the body's x axis, in closed form.
  Eigen::Vector3d integrate(double t_s) const {
    const double w = rate_radps.norm();
    const Eigen::Matrix3d S = geometry::skew(rate_radps);
    const Eigen::Matrix3d V = t_s * Eigen::Matrix3d::Identity() + (1.0 - std::cos(w * t_s)) / (w * w) * S +
                              (w * t_s - std::sin(w * t_s)) / (w * w * w) * S * S;
    return V * Eigen::Vector3d(speed_mps, 0.0, 0.0);
  }

  ImuSample sample(Stamp stamp, double t_s) const {
    const Eigen::Matrix3d R = geometry::so3_exp(rate_radps * t_s);
    const Eigen::Vector3d centripetal = rate_radps.cross(Eigen::Vector3d(speed_mps, 0.0, 0.0));
    return {stamp, rate_radps, centripetal + R.transpose() * Eigen::Vector3d(0.0, 0.0, inertial::kGravityMps2)};
  }
};

TEST(ScanMotion, BringsEachPointToTheScansEnd) {
  const Bend bend;
  inertial::NavState state;
  state.T_odom_imu = bend.T_odom_imu(0.0);
  state.v_odom_imu = {bend.speed_mps, 0.0, 0.0};
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 60; ++i) {
    samples.push_back(bend.sample(Stamp{} + i * std::chrono::milliseconds(5), 0.005 * i));
  }
  const Stamp begin = Stamp{} + std::chrono::milliseconds(103);
  const Stamp end = begin + std::chrono::microseconds(99'500);
  ScanMotion sut(std::chrono::milliseconds(200));

  sut.predict(state, samples, begin, end);

  const Se3 T_end_odom = bend.T_odom_imu(to_seconds(end - Stamp{})).inverse();
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(-40.0, 40.0);
  for (std::uint32_t offset_ns = 0; offset_ns < 99'500'000; offset_ns += 777'777) {
    const Eigen::Vector3d p_imu(uniform(engine), uniform(engine), 0.1 * uniform(engine));
    const double t_s = to_seconds(begin - Stamp{}) + 1e-9 * offset_ns;
    const Eigen::Vector3d expected = T_end_odom * (bend.T_odom_imu(t_s) * p_imu);

    const Eigen::Vector3f found = sut.to_end(p_imu.cast<float>(), offset_ns);

    ASSERT_LT((found.cast<double>() - expected).norm(), 1e-3) << "at " << offset_ns << " ns";
  }
  EXPECT_NEAR(sut.turned_rad(), bend.rate_radps.norm() * 0.0995, 1e-4);
}

TEST(ScanMotion, WithoutSamplesKeepsVelocityAndTurnRate) {
  inertial::NavState state;
  state.v_odom_imu = {10.0, 0.0, 0.0};
  state.gyro_bias = {0.0, 0.0, -1.0};  // −ω
  ScanMotion sut(std::chrono::milliseconds(200));

  sut.predict(state, {}, Stamp{} + std::chrono::milliseconds(100), Stamp{} + std::chrono::milliseconds(200));

  EXPECT_NEAR(sut.turned_rad(), 0.1, 1e-6);
  EXPECT_NEAR(sut.moved_m(), 1.0, 1e-3);
}

TEST(ScanMotion, StillMovesNothing) {
  ScanMotion sut(std::chrono::milliseconds(200));

  sut.set_still(Stamp{}, Stamp{} + std::chrono::milliseconds(100));

  EXPECT_EQ(sut.to_end({1.0F, 2.0F, 3.0F}, 50'000'000), Eigen::Vector3f(1.0F, 2.0F, 3.0F));
}

TEST(ScanMotion, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const Bend bend;
  const std::vector<ImuSample> samples{bend.sample(Stamp{}, 0.0), bend.sample(Stamp{} + std::chrono::seconds(1), 1.0)};
  ScanMotion sut(std::chrono::milliseconds(200));

  const std::size_t allocations = support::count_allocations([&] {
    sut.predict(inertial::NavState{}, samples, Stamp{} + std::chrono::milliseconds(1), Stamp{} + std::chrono::milliseconds(101));
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::scan
