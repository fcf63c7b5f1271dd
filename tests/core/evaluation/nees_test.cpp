#include "core/evaluation/nees.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <vector>

#include "core/geometry/so3.hpp"

namespace slamd::evaluation {
namespace {

using geometry::Matrix6d;
using geometry::Se3;
using geometry::Vector6d;

Stamp at(int i) { return Stamp{} + std::chrono::milliseconds(100 * i); }

TEST(MotionErrors, WeighTheErrorByItsVariance) {
  const Se3 step(geometry::rotation_from_rpy({0, 0, 0.5}), {1.0, 0.0, 0.0});
  const Se3 anywhere(geometry::rotation_from_rpy({0.1, 0.2, 2.0}), {7.0, 8.0, 9.0});
  Vector6d error;
  error << 0.1, 0.0, -0.2, 0.0, 0.03, 0.0;
  const std::vector<PosePair> pairs = {{at(0), Se3{}, anywhere},
                                       {at(1), step, anywhere * geometry::boxplus(step, error)}};
  Matrix6d P = Matrix6d::Identity();
  P.diagonal() << 0.01, 0.01, 0.04, 1e-4, 9e-4, 1e-4;

  const MotionConsistency sut = consistency_of(motion_errors(pairs, std::vector<MotionClaim>{{at(0), at(1), P}}));

  ASSERT_EQ(sut.pose.count, 1U);
  EXPECT_NEAR(sut.pose.mean, 1.0 + 1.0 + 1.0, 1e-9);
  EXPECT_NEAR(sut.position.mean, 2.0, 1e-9);
  EXPECT_NEAR(sut.rotation.mean, 1.0, 1e-9);
  EXPECT_NEAR(sut.axes[2].mean, 1.0, 1e-9);
  EXPECT_NEAR(sut.error_rms[2], 0.2, 1e-9);
  EXPECT_NEAR(sut.claimed_rms[4], 0.03, 1e-9);
}

TEST(MotionErrors, AverageToTheDegreesOfFreedomForHonestCovariances) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.01);
  std::vector<PosePair> pairs;
  std::vector<MotionClaim> honest;
  std::vector<MotionClaim> proud;
  Se3 reference;
  Se3 estimate;
  const Se3 step(geometry::rotation_from_rpy({0.0, 0.01, 0.1}), {1.0, 0.1, 0.0});
  for (int i = 0; i < 3000; ++i) {
    pairs.push_back({at(i), reference, estimate});
    Vector6d error;
    for (double& value : error) {
      value = normal(random);
    }
    reference = reference * step;
    estimate = estimate * geometry::boxplus(step, error);
    if (i > 0) {
      honest.push_back({at(i - 1), at(i), 1e-4 * Matrix6d::Identity()});
      proud.push_back({at(i - 1), at(i), 0.25e-4 * Matrix6d::Identity()});
    }
  }

  const MotionConsistency of_honest = consistency_of(motion_errors(pairs, honest));
  const MotionConsistency of_proud = consistency_of(motion_errors(pairs, proud));

  EXPECT_NEAR(of_honest.pose.mean, 6.0, 0.3);
  EXPECT_NEAR(of_honest.pose.inside_95, 0.95, 0.02);
  EXPECT_NEAR(of_honest.position.inside_95, 0.95, 0.02);
  EXPECT_NEAR(of_honest.rotation.inside_95, 0.95, 0.02);
  EXPECT_NEAR(of_honest.axes[5].inside_95, 0.95, 0.02);
  EXPECT_NEAR(of_proud.pose.mean, 24.0, 1.2);
  EXPECT_LT(of_proud.pose.inside_95, 0.4);
}

TEST(MotionErrors, LeaveOutClaimsWithoutPoses) {
  const std::vector<PosePair> pairs = {{at(0), Se3{}, Se3{}}, {at(2), Se3{}, Se3{}}};

  const auto sut = motion_errors(pairs, std::vector<MotionClaim>{{at(0), at(1), Matrix6d::Identity()},
                                                                 {at(0), at(2), Matrix6d::Identity()}});

  EXPECT_EQ(sut.size(), 1U);
}

TEST(MotionErrors, RefuseWhatIsNoCovariance) {
  EXPECT_THROW(consistency_of(std::vector<MotionError>{{Vector6d::Zero(), Matrix6d::Zero()}}), std::invalid_argument);
}

}  // namespace
}  // namespace slamd::evaluation
