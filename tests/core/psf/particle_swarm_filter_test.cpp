#include "core/psf/particle_swarm_filter.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/so3.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/world/room.hpp"

namespace slamd::psf {
namespace {

using geometry::Se3;
using geometry::Vector6d;

const Se3 kTruth(geometry::so3_exp({0.02, -0.01, 0.7}), Eigen::Vector3d(0.5, -0.5, 1.0));

class ParticleSwarmFilterTest : public testing::Test {
 protected:
  ParticleSwarmFilterTest() : map_(map::VoxelMapConfig{}) {
    std::mt19937_64 engine(1);
    for (int i = 0; i < 16; ++i) {
      const Se3 T_odom_lidar(geometry::so3_exp({0.05 * i, 0.03 * i, 0.5 * i}),
                             Eigen::Vector3d(0.25 * i - 1.5, 0.1 * i - 0.5, 1.2));
      std::vector<Eigen::Vector3f> points = world::Room().points_lidar(T_odom_lidar, 720, 0.01, engine);
      for (Eigen::Vector3f& p : points) {
        p = (T_odom_lidar * p.cast<double>()).cast<float>();
      }
      map_.insert(points, 0.0);
    }
    points_ = world::Room().points_lidar(kTruth, 13, 0.01, engine);
  }

  Question question(const Vector6d& prior_error, const Se3& T_plain) const {
    Question question;
    question.T_odom_imu_prior = geometry::boxplus(kTruth, prior_error);
    question.P_prior = geometry::Matrix6d::Identity() * 1e-4;
    question.T_odom_imu_plain = T_plain;
    question.indoor = true;
    return question;
  }

  map::VoxelMap map_;
  std::vector<Eigen::Vector3f> points_;
};

TEST_F(ParticleSwarmFilterTest, CachedLikelihoodEqualsLookUpsWhereItWasCached) {
  ScanLikelihood sut(points_.size());
  sut.set_points(points_);
  for (const double offset_m : {0.0, 0.05, 0.3, 5.0}) {
    const Se3 T = geometry::boxplus(kTruth, offset_m * Vector6d::Ones());

    sut.cache_surfaces(map_, 0, T);

    EXPECT_NEAR(sut.with_cache(T, 0.1F), sut.with_look_ups(map_, 0, T, 0.1F), 1e-3F);
  }
}

TEST_F(ParticleSwarmFilterTest, LikelihoodPeaksAtTheTruth) {
  ScanLikelihood sut(points_.size());
  sut.set_points(points_);
  const float at_truth = sut.with_look_ups(map_, 0, kTruth, 0.1F);

  for (int axis = 0; axis < 6; ++axis) {
    EXPECT_GT(at_truth, sut.with_look_ups(map_, 0, geometry::boxplus(kTruth, 0.3 * Vector6d::Unit(axis)), 0.1F) + 0.05F);
  }
  EXPECT_GE(sut.with_look_ups(map_, 0, geometry::boxplus(kTruth, 100.0 * Vector6d::Unit(0)), 0.1F),
            -ScanLikelihood::kFullCost);
}

TEST_F(ParticleSwarmFilterTest, LittleSwarmLeavesAGoodUpdateAlone) {
  ParticleSwarmFilter sut(PsfConfig{}, 1);
  for (std::uint64_t scan = 0; scan < 20; ++scan) {
    Question asked = question(0.01 * Vector6d::Ones(), kTruth);
    asked.scan_index = scan;

    const Answer answer = sut.answer(points_, map_, asked);

    EXPECT_FALSE(answer.recovery);
    EXPECT_FALSE(answer.swarm_won);
    EXPECT_EQ(answer.particles, 32U);
  }
}

TEST_F(ParticleSwarmFilterTest, RecoverySwarmFindsTheTruthFromWrongPredictions) {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int found = 0;
  for (std::uint64_t run = 0; run < 40; ++run) {
    Vector6d error;
    error << uniform(engine), uniform(engine), 0.2 * uniform(engine), 0.05 * uniform(engine), 0.05 * uniform(engine),
        0.17 * uniform(engine);
    Question asked = question(error, geometry::boxplus(kTruth, error));  // and the plain update did not move
    asked.distrust_prior = true;
    asked.scan_index = run;
    ParticleSwarmFilter sut(PsfConfig{}, 1);

    const Answer answer = sut.answer(points_, map_, asked);

    const Vector6d left = geometry::boxminus(answer.T_odom_imu, kTruth);
    EXPECT_TRUE(answer.recovery);
    found += left.head<3>().norm() < 0.15 && left.tail<3>().norm() < 0.03 ? 1 : 0;
  }

  EXPECT_GE(found, 34);
}

TEST_F(ParticleSwarmFilterTest, FallingLikelihoodTriggersTheRecoveryWhichKeepsToAPriorThatNothingContradicts) {
  ParticleSwarmFilter sut(PsfConfig{}, 1);
  for (std::uint64_t scan = 0; scan < 10; ++scan) {
    sut.answer(points_, map_, question(Vector6d::Zero(), kTruth));
  }
  Vector6d error = Vector6d::Zero();
  error[0] = 0.8;
  error[5] = 0.12;

  Question asked = question(error, geometry::boxplus(kTruth, error));
  ParticleSwarmFilter other = sut;

  const Answer kept = sut.answer(points_, map_, asked);
  asked.distrust_prior = true;
  const Answer found = other.answer(points_, map_, asked);

  EXPECT_TRUE(kept.recovery);
  EXPECT_FALSE(kept.swarm_won);
  EXPECT_TRUE(found.recovery);
  EXPECT_TRUE(found.swarm_won);
  EXPECT_LT(geometry::boxminus(found.T_odom_imu, kTruth).norm(), 0.15);
}

TEST_F(ParticleSwarmFilterTest, SameSeedSameAnswer) {
  Question asked = question(0.3 * Vector6d::Unit(0), kTruth);
  asked.distrust_prior = true;
  ParticleSwarmFilter a(PsfConfig{}, 9);
  ParticleSwarmFilter b(PsfConfig{}, 9);

  const Answer first = a.answer(points_, map_, asked);
  const Answer second = b.answer(points_, map_, asked);

  EXPECT_EQ(first.T_odom_imu.translation(), second.T_odom_imu.translation());
  EXPECT_EQ(first.spread_m, second.spread_m);
}

TEST_F(ParticleSwarmFilterTest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  ParticleSwarmFilter sut(PsfConfig{}, 1);
  Question asked = question(0.2 * Vector6d::Unit(1), kTruth);

  const std::size_t allocations = support::count_allocations([&] {
    sut.answer(points_, map_, asked);
    asked.distrust_prior = true;
    sut.answer(points_, map_, asked);
  });

  EXPECT_EQ(allocations, 0U);
}

TEST(Swarm, SpreadCoversEachAxisEvenlyAndHoldsThePrediction) {
  Swarm sut(SwarmConfig{}, 64);
  Random random(1, 2);
  const Vector6d half = (Vector6d() << 1.0, 2.0, 3.0, 0.1, 0.2, 0.3).finished();

  sut.spread(33, half, random);

  EXPECT_EQ(sut[0].xi.norm(), 0.0);
  for (int axis = 0; axis < 6; ++axis) {
    int stratum_hits[32] = {};
    for (std::size_t i = 1; i < sut.size(); ++i) {
      const double place = 0.5 * (sut[i].xi[axis] / half[axis] + 1.0);
      ASSERT_GE(place, 0.0);
      ASSERT_LT(place, 1.0);
      ++stratum_hits[static_cast<int>(32.0 * place)];
    }
    for (const int hits : stratum_hits) {
      EXPECT_EQ(hits, 1);
    }
  }
}

TEST(Swarm, ConvergesOnTheBestPlace) {
  const SwarmConfig config{.steps = 40};
  Swarm sut(config, 64);
  Random random(3, 4);
  const Vector6d target = (Vector6d() << 0.4, -0.3, 0.2, 0.05, -0.02, 0.1).finished();
  sut.spread(64, Vector6d::Ones(), random);

  for (int step = 0; step < config.steps; ++step) {
    sut.score([&](const Vector6d& xi) { return static_cast<float>(-(xi - target).squaredNorm()); });
    sut.resample(step, random);
    sut.move(step, random);
  }

  EXPECT_LT((sut.best().best_xi - target).norm(), 0.05);
}

}  // namespace
}  // namespace slamd::psf
