#include "core/graph/back_end.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "square_drive.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::graph {
namespace {

BackEndConfig small_config() {
  BackEndConfig config;
  config.capacity.keyframes = 400;
  config.capacity.loops = 40;
  config.factor_entries = 300'000;
  return config;
}

bool told(const Update& update, LoopId id, LoopVerdict verdict) {
  return std::any_of(update.loops.begin(), update.loops.end(),
                     [&](const LoopEvent& event) { return event.id == id && event.verdict == verdict; });
}

/// Proposes and expects it to wait.
LoopId pend(BackEnd& sut, const LoopCandidate& candidate) {
  LoopId id = 0;
  EXPECT_EQ(sut.propose(candidate, id), Proposal::kPending);
  return id;
}

TEST(BackEnd, LeavesPosesAtTheOdometryUntilALoopIsSupported) {
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);

  pend(sut, drive.loop(5, 85));
  const Update update = sut.update();

  EXPECT_EQ(update.kind, UpdateKind::kNone);
  EXPECT_EQ(sut.pending(), 1U);
  EXPECT_LT(boxminus(sut.graph().node(99).T_map_base, drive.T_odom_base[99]).norm(), 1e-9);
}

TEST(BackEnd, CorrectsTheMapOnceTwoLoopsSayTheSame) {
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  const double before = drive.error(sut.graph());

  const LoopId first = pend(sut, drive.loop(5, 85));
  const LoopId second = pend(sut, drive.loop(15, 95));
  const Update update = sut.update();

  EXPECT_EQ(update.kind, UpdateKind::kWarm);
  EXPECT_EQ(update.end, OptimiserEnd::kConverged);
  EXPECT_TRUE(told(update, first, LoopVerdict::kAccepted) && told(update, second, LoopVerdict::kAccepted));
  EXPECT_GT(before, 1.0);
  EXPECT_LT(drive.error(sut.graph()), 0.4 * before);
  EXPECT_LT((sut.T_map_odom() * drive.T_odom_base[99].translation() - drive.T_world_base[99].translation()).norm(), 0.2);
}

TEST(BackEnd, LetsAStrongLoopInAlone) {
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  LoopCandidate strong = drive.loop(15, 95);
  strong.strong = true;

  pend(sut, strong);

  EXPECT_EQ(sut.update().loops.size(), 1U);
}

TEST(BackEnd, RefusesWhatContradictsTheOdometry) {
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  LoopId id = 0;

  EXPECT_EQ(sut.propose(drive.loop(5, 85, {40.0, 0.0, 0.0}), id), Proposal::kContradictsOdometry);
}

TEST(BackEnd, RefusesALoopWhoseCovarianceIsNone) {
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  LoopCandidate unsure = drive.loop(15, 95);
  unsure.strong = true;
  unsure.motion.covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  LoopId id = 0;

  EXPECT_EQ(sut.propose(unsure, id), Proposal::kContradictsOdometry);
}

TEST(BackEnd, DoesNotLetALoopSupportItself) {
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  LoopId id = 0;
  pend(sut, drive.loop(15, 95));

  EXPECT_EQ(sut.propose(drive.loop(15, 95), id), Proposal::kKnownPair);
  EXPECT_EQ(sut.update().loops.size(), 0U);
}

TEST(BackEnd, RefusesALoopToAKeyframeThatWasRetired) {
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  sut.retire(50);
  LoopId id = 0;

  EXPECT_EQ(sut.propose(drive.loop(50, 95), id), Proposal::kNoKeyframe);
}

TEST(BackEnd, DoesNotTakeTwoLoopsForSupportThatContradictEachOther) {
  const SquareDrive drive(100, 0.02, 0.006);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);

  pend(sut, drive.loop(14, 94));
  pend(sut, drive.loop(15, 95, {1.5, 0.0, 0.0}));

  EXPECT_EQ(sut.update().loops.size(), 0U);
  EXPECT_EQ(sut.pending(), 2U);
}

TEST(BackEnd, GivesUpALoopThatNothingSupports) {
  const SquareDrive drive(400);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  const LoopId id = pend(sut, drive.loop(5, 85));
  drive.drive(sut, 100, 287);

  EXPECT_TRUE(told(sut.update(), id, LoopVerdict::kGivenUp));
  EXPECT_EQ(sut.pending(), 0U);
}

TEST(BackEnd, TakesLoopsOutThatMoreLaterOnesDisagreeWith) {
  const SquareDrive drive(400, 0.02, 0.006);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  // Two rows of racks that look alike: the same mistake twice.
  const LoopId wrong = pend(sut, drive.loop(14, 94, {1.5, 0.0, 0.0}));
  const LoopId wrong_too = pend(sut, drive.loop(15, 95, {1.5, 0.0, 0.0}));
  ASSERT_TRUE(told(sut.update(), wrong, LoopVerdict::kAccepted));

  drive.drive(sut, 100, 200);
  bool taken_out = false;
  for (std::size_t k = 100; k < 116; ++k) {
    LoopId id = 0;
    sut.propose(drive.loop(k - 80, k), id);
    const Update update = sut.update();
    taken_out = taken_out || told(update, wrong, LoopVerdict::kTakenOut);
  }

  EXPECT_TRUE(taken_out);
  for (std::size_t k = 0; k < sut.graph().loops(); ++k) {
    const Loop& loop = sut.graph().loop(k);
    EXPECT_EQ(loop.enabled, loop.id != wrong && loop.id != wrong_too) << loop.id;
  }
}

TEST(BackEnd, RefusesTheKeyframeBeyondItsLimitAndGoesOnOnceOneIsRetired) {
  BackEndConfig config;  // as shipped: 10,000
  config.factor_entries = 1'000'000;
  const SquareDrive drive(10'002);
  const auto sut = std::make_unique<BackEnd>(config);

  EXPECT_EQ(drive.drive(*sut, 0, 10'001), 10'000U);
  EXPECT_EQ(sut->graph().size(), 10'000U);

  sut->retire(5'000);
  EXPECT_EQ(drive.drive(*sut, 10'000, 10'002), 1U);
}

TEST(BackEnd, KeepsLoopsFixesAndTheWayOverARetiredKeyframe) {
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 100);
  pend(sut, drive.loop(5, 85));
  pend(sut, drive.loop(15, 95));
  sut.add_fix(50, {{1.0, 2.0, 3.0}, {0.5, 0.0, 1.0}, 1.0, 2.0});
  sut.update();
  const Motion before = sut.chain().between(4, 96);
  const double error = drive.error(sut.graph());

  for (KeyframeId id : {5U, 15U, 50U, 85U, 95U}) {
    sut.retire(id);
  }
  LoopCandidate strong = drive.loop(17, 97);
  strong.strong = true;
  pend(sut, strong);
  const Update update = sut.update();

  EXPECT_EQ(sut.graph().size(), 95U);
  EXPECT_EQ(sut.graph().loop(0).a, 6U);
  EXPECT_EQ(sut.graph().loop(0).b, 86U);
  EXPECT_LT((sut.graph().loop(0).factor.T_a_b.translation() - drive.loop(6, 86).motion.T_a_b.translation()).norm(), 0.02);
  EXPECT_LT((sut.chain().between(4, 91).covariance - before.covariance).norm(), 1e-9);
  const GnssFactor& fix = *sut.graph().node(sut.graph().index_of(51)).fix;
  EXPECT_NEAR(fix.p_base_antenna.x(), -0.5, 0.01);  // a metre behind
  EXPECT_EQ(update.kind, UpdateKind::kWarm);
  EXPECT_NEAR(drive.error(sut.graph()), error, 0.1);
}

TEST(BackEnd, MakesRoomForLoopsFromThoseTakenOutAndSaysWhenThereIsNone) {
  BackEndConfig config = small_config();
  config.capacity.loops = 2;
  const SquareDrive drive(100);
  BackEnd sut(config);
  drive.drive(sut, 0, 100);
  for (std::size_t k = 90; k < 92; ++k) {
    pend(sut, drive.loop(k - 80, k));
  }
  ASSERT_EQ(sut.update().kind, UpdateKind::kWarm);

  const LoopId third = pend(sut, drive.loop(12, 92));

  EXPECT_TRUE(told(sut.update(), third, LoopVerdict::kNoRoom));
  EXPECT_EQ(sut.graph().loops(), 2U);
}

TEST(BackEnd, LeavesTheMapAsItWasWhereTheFactorisationDoesNotFit) {
  BackEndConfig config = small_config();
  config.factor_entries = 100 * 15 + 99 * 36;  // a chain without loops
  const SquareDrive drive(100);
  BackEnd sut(config);
  drive.drive(sut, 0, 100);
  const LoopId first = pend(sut, drive.loop(5, 85));
  pend(sut, drive.loop(15, 95));

  const Update update = sut.update();

  EXPECT_EQ(update.end, OptimiserEnd::kFactorTooLarge);
  EXPECT_TRUE(told(update, first, LoopVerdict::kNoRoom));
  EXPECT_EQ(sut.graph().loops(), 0U);
  EXPECT_LT(boxminus(sut.graph().node(99).T_map_base, drive.T_odom_base[99]).norm(), 1e-9);
}

TEST(BackEnd, AlignsTheReceiversAxesOnceTheMotionTellsThem) {
  const GnssAlignment truth{1.0, {5.0, -3.0, 2.0}};
  const SquareDrive drive(400, 0.01, 0.0005);
  BackEnd sut(small_config());
  Draw draw(1);
  std::size_t aligned_at = 0;
  for (std::size_t i = 0; i < 400; ++i) {
    drive.drive(sut, i, i + 1);
    GnssFactor fix{truth.inverse_times(drive.T_world_base[i] * Eigen::Vector3d(-0.15, 0.0, 0.45)) + draw.vector(0.5),
                   {-0.15, 0.0, 0.45}, 0.5, 0.5};
    fix.p_enu.x() += i >= 200 && i < 230 ? 15.0 : 0.0;
    sut.add_fix(static_cast<KeyframeId>(i), fix);
    sut.update();
    aligned_at = aligned_at == 0 && sut.graph().alignment() ? i : aligned_at;
  }

  EXPECT_GT(aligned_at, 10U);
  EXPECT_LT(aligned_at, 60U);
  EXPECT_NEAR(sut.graph().alignment()->yaw_rad, truth.yaw_rad, 0.03);
  EXPECT_LT((sut.graph().alignment()->p_map_enu - truth.p_map_enu).norm(), 0.5);
  EXPECT_LT(drive.error(sut.graph()), 0.8);
  for (std::size_t i = 200; i < 230; ++i) {
    EXPECT_EQ(sut.graph().node(i).fix_weight, 0.0) << i;
  }
}

TEST(BackEnd, TakesNoMemoryOfItsOwnForKeyframesAndProposals) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  const SquareDrive drive(100);
  BackEnd sut(small_config());
  drive.drive(sut, 0, 99);

  const std::size_t count = support::count_allocations([&] {
    drive.drive(sut, 99, 100);
    for (std::size_t k = 0; k < 20; ++k) {
      LoopCandidate lone = drive.loop(k, 80 + k, {0.4 * static_cast<double>(k % 7), 0.0, 0.0});
      LoopId id = 0;
      sut.propose(lone, id);
    }
    sut.retire(50);
  });

  EXPECT_EQ(count, 0U);
}

}  // namespace
}  // namespace slamd::graph
