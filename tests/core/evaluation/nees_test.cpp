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

TEST(RelativeNees, WeighsTheErrorByItsVariance) {
  const Se3 step(geometry::rotation_from_rpy({0, 0, 0.5}), {1.0, 0.0, 0.0});
  const Se3 anywhere(geometry::rotation_from_rpy({0.1, 0.2, 2.0}), {7.0, 8.0, 9.0});
  Vector6d error;
  error << 0.1, 0.0, -0.2, 0.0, 0.03, 0.0;
  const std::vector<PosePair> pairs = {{Stamp{}, Se3{}, anywhere},
                                       {Stamp{}, step, anywhere * geometry::boxplus(step, error)}};
  Matrix6d P = Matrix6d::Identity();
  P.diagonal() << 0.01, 0.01, 0.04, 1e-4, 9e-4, 1e-4;

  const auto sut = relative_nees(pairs, std::vector<IndexPair>{{0, 1}}, std::vector<Matrix6d>{P});

  ASSERT_EQ(sut.size(), 1U);
  EXPECT_NEAR(sut[0], 1.0 + 1.0 + 1.0, 1e-9);
}

TEST(RelativeNees, AveragesToSixForHonestCovariances) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.01);
  std::vector<PosePair> pairs;
  std::vector<IndexPair> indices;
  Se3 reference;
  Se3 estimate;
  const Se3 step(geometry::rotation_from_rpy({0.0, 0.01, 0.1}), {1.0, 0.1, 0.0});
  for (std::size_t i = 0; i < 3000; ++i) {
    pairs.push_back({Stamp{}, reference, estimate});
    Vector6d error;
    for (double& value : error) {
      value = normal(random);
    }
    reference = reference * step;
    estimate = estimate * geometry::boxplus(step, error);
    if (i > 0) {
      indices.push_back({i - 1, i});
    }
  }
  const std::vector<Matrix6d> honest(indices.size(), 1e-4 * Matrix6d::Identity());
  const std::vector<Matrix6d> proud(indices.size(), 0.25e-4 * Matrix6d::Identity());

  const Consistency of_honest = consistency_of(relative_nees(pairs, indices, honest));
  const Consistency of_proud = consistency_of(relative_nees(pairs, indices, proud));

  EXPECT_NEAR(of_honest.mean, 6.0, 0.3);
  EXPECT_NEAR(of_honest.inside_95, 0.95, 0.02);
  EXPECT_NEAR(of_proud.mean, 24.0, 1.2);
  EXPECT_LT(of_proud.inside_95, 0.4);
}

TEST(RelativeNees, RefusesWhatIsNoCovariance) {
  const std::vector<PosePair> pairs(2);
  const std::vector<IndexPair> indices = {{0, 1}};

  EXPECT_THROW(relative_nees(pairs, indices, {}), std::invalid_argument);
  EXPECT_THROW(relative_nees(pairs, indices, std::vector<Matrix6d>{Matrix6d::Zero()}),
               std::invalid_argument);
}

}  // namespace
}  // namespace slamd::evaluation
