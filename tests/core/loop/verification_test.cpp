#include "core/loop/verification.hpp"

#include <gtest/gtest.h>

#include "core/geometry/so3.hpp"
#include "tests/world/room.hpp"

namespace slamd::loop {
namespace {

using geometry::Se3;

Se3 pose_at(double x, double y, double z, double yaw_rad) {
  return {geometry::rotation_from_rpy({0.0, 0.0, yaw_rad}), {x, y, z}};
}

/// Clouds of a hall, seen from around a candidate and from a query some way off.
struct LoopVerifierTest : testing::Test {
  LoopVerifierTest() : sut(VerificationConfig{}) {
    sut.set_submap(submap(), 6'400);
    query = room.points_lidar(T_odom_query, 400, 0.02, engine);
  }

  std::vector<Eigen::Vector3f> submap() {
    std::vector<Eigen::Vector3f> points;
    for (const double along_m : {0.0, -1.0, 1.0}) {
      const Se3 T_odom_near = T_odom_candidate * pose_at(along_m, 0.0, 0.0, 0.1 * along_m);
      const Eigen::Matrix3f T = (T_odom_candidate.inverse() * T_odom_near).rotation().cast<float>();
      const Eigen::Vector3f t = (T_odom_candidate.inverse() * T_odom_near).translation().cast<float>();
      for (const Eigen::Vector3f& p : room.points_lidar(T_odom_near, 400, 0.02, engine)) {
        points.push_back(T * p + t);
      }
    }
    return points;
  }

  LoopProposal proposal_off_by(const Se3& error, double position_std_m, double yaw_std_rad) const {
    LoopProposal proposal;
    proposal.T_candidate_query = T_true * error;
    proposal.position_std_m = position_std_m;
    proposal.yaw_std_rad = yaw_std_rad;
    return proposal;
  }

  /// The query with points that it alone has: as seen from the candidate, at a share of the range of what stands there.
  std::vector<Eigen::Vector3f> query_with_points_at(double share) const {
    std::vector<Eigen::Vector3f> points = query;
    for (std::size_t i = 0; i < query.size(); ++i) {
      if (i % 10 < 7) {
        points.push_back((T_true.inverse() * (share * (T_true * query[i].cast<double>()))).cast<float>());
      }
    }
    return points;
  }

  world::Room room;
  std::mt19937_64 engine{7};
  Se3 T_odom_candidate = pose_at(0.0, 1.0, 1.0, 0.4);
  Se3 T_odom_query = pose_at(1.5, 0.0, 1.0, 2.6);
  Se3 T_true = T_odom_candidate.inverse() * T_odom_query;
  LoopVerifier sut;
  std::vector<Eigen::Vector3f> query;
};

TEST_F(LoopVerifierTest, FindsThePlaceFromAnUncertainGuess) {
  const Verification found = sut.verify(query, proposal_off_by(pose_at(1.6, -1.2, 0.1, 0.12), 1.5, 0.1));

  EXPECT_EQ(found.verdict, Verdict::kVerified) << name_of(found.verdict);
  const geometry::Vector6d error = geometry::boxminus(found.T_candidate_query, T_true);
  EXPECT_LT(error.head<3>().norm(), 0.03);
  EXPECT_LT(error.tail<3>().norm(), 0.005);
  EXPECT_LT(error.dot(found.covariance.inverse() * error), 16.8) << "χ²₆(0.99)";
}

TEST_F(LoopVerifierTest, BelievesLessOverlapAfterASearchOnlyWhereTheRestWasOccluded) {
  const LoopProposal uncertain = proposal_off_by(pose_at(0.4, -0.3, 0.0, 0.02), 0.5, 0.02);

  const Verification occluded = sut.verify(query_with_points_at(1.6), uncertain);
  const Verification contradicted = sut.verify(query_with_points_at(0.5), uncertain);

  EXPECT_TRUE(occluded.searched);
  EXPECT_LT(occluded.overlap, VerificationConfig{}.min_overlap_searched);
  EXPECT_EQ(occluded.verdict, Verdict::kVerified) << name_of(occluded.verdict) << ", runner-up " << occluded.runner_up;
  EXPECT_NE(contradicted.verdict, Verdict::kVerified);
  EXPECT_GT(contradicted.seen_through, 0.1);
}

TEST_F(LoopVerifierTest, RefusesAnotherPlace) {
  std::vector<Eigen::Vector3f> elsewhere;
  for (const Eigen::Vector3f& p : query) {
    elsewhere.emplace_back(1.7F * p.y(), 0.6F * p.x() + 0.3F * p.y(), p.z());
  }

  const Verification found = sut.verify(elsewhere, proposal_off_by(Se3(), 1.5, 0.1));

  EXPECT_NE(found.verdict, Verdict::kVerified);
}

TEST_F(LoopVerifierTest, RefusesWhatItHasHardlyAnyPointsOf) {
  const Verification found = sut.verify(std::span(query).first(50), proposal_off_by(Se3(), 0.1, 0.01));

  EXPECT_EQ(found.verdict, Verdict::kFewPoints);
}

TEST_F(LoopVerifierTest, RefusesAYawThatIsNotTheProposals) {
  const Verification found = sut.verify(query, proposal_off_by(pose_at(0.0, 0.0, 0.0, 0.15), 0.1, 0.01));

  EXPECT_EQ(found.verdict, Verdict::kYawDisagrees);
}

TEST_F(LoopVerifierTest, RefusesAPoseWhereOneCloudHasLookedThroughTheOther) {
  std::vector<Eigen::Vector3f> far_wall;
  std::vector<Eigen::Vector3f> near_wall;
  for (double y = -6.0; y <= 6.0; y += 0.2) {
    for (double z = -1.0; z <= 3.0; z += 0.2) {
      far_wall.emplace_back(10.0F, static_cast<float>(y), static_cast<float>(z));
      near_wall.emplace_back(4.0F, static_cast<float>(y), static_cast<float>(z));
    }
  }
  View view;
  view.add(far_wall);

  EXPECT_GT(view.seen_through(near_wall, Se3()).share(), 0.9);
  EXPECT_EQ(view.seen_through(far_wall, Se3()).share(), 0.0);
  EXPECT_EQ(view.seen_through(near_wall, pose_at(6.0, 0.0, 0.0, 0.0)).share(), 0.0);
  EXPECT_EQ(view.seen_through(far_wall, pose_at(20.0, 0.0, 0.0, 0.0)).share(), 0.0) << "behind what was seen anything may be";
}

TEST(SeenThrough, LetsOneStrayPointInASmallFieldWeighLittleAmongModes) {
  const VerificationConfig config;
  const auto share = [&](std::size_t in_field, std::size_t through) { return SeenThrough{in_field, through}.share_of_at_least(config.sight_points); };

  EXPECT_EQ(share(49, 49), 0.0);
  EXPECT_GT(std::exp(-share(50, 1) / config.sight_scale), config.ambiguity_score) << "two modes that fit as well stay two";
  EXPECT_LT(std::exp(-share(50, 5) / config.sight_scale), 0.5);
  EXPECT_EQ(share(1'000, 20), 0.02);
}

/// A corridor of two walls and a floor, a forest of equal shelves between them if wanted.
std::vector<Eigen::Vector3f> corridor(double shelf_every_m, double shift_m) {
  std::vector<Eigen::Vector3f> points;
  for (double x = -20.0; x <= 20.0; x += 0.25) {
    for (double h = 0.0; h <= 2.5; h += 0.25) {
      points.emplace_back(static_cast<float>(x), 2.0F, static_cast<float>(h - 1.0));
      points.emplace_back(static_cast<float>(x), -2.0F, static_cast<float>(h - 1.0));
      points.emplace_back(static_cast<float>(x), static_cast<float>(1.6 * h - 2.0), -1.0F);
    }
  }
  for (double x = -18.0; shelf_every_m > 0.0 && x <= 18.0; x += shelf_every_m) {
    for (double y = 0.8; y <= 2.0; y += 0.15) {
      for (double h = 0.0; h <= 2.0; h += 0.15) {
        for (const double side : {-1.0, 1.0}) {
          points.emplace_back(static_cast<float>(x + shift_m), static_cast<float>(side * y), static_cast<float>(h - 1.0));
        }
      }
    }
  }
  return points;
}

TEST_F(LoopVerifierTest, CallsABareCorridorDegenerateOrAmbiguous) {
  const std::vector<Eigen::Vector3f> walls = corridor(0.0, 0.0);
  sut.set_submap(walls, walls.size());
  LoopProposal proposal;
  proposal.position_std_m = 1.0;

  const Verification found = sut.verify(walls, proposal);

  EXPECT_TRUE(found.verdict == Verdict::kDegenerate || found.verdict == Verdict::kAmbiguous) << name_of(found.verdict);
}

TEST_F(LoopVerifierTest, CallsShelvesThatRepeatAmbiguousWhereTheGuessCannotTellThemApart) {
  const std::vector<Eigen::Vector3f> again = corridor(2.7, 0.0);
  sut.set_submap(again, again.size());
  LoopProposal proposal;
  proposal.position_std_m = 1.5;

  const Verification uncertain = sut.verify(again, proposal);
  proposal.position_std_m = 0.1;
  proposal.yaw_std_rad = 0.01;
  const Verification certain = sut.verify(again, proposal);

  EXPECT_EQ(uncertain.verdict, Verdict::kAmbiguous) << name_of(uncertain.verdict);
  EXPECT_EQ(certain.verdict, Verdict::kVerified) << name_of(certain.verdict);
}

}  // namespace
}  // namespace slamd::loop
