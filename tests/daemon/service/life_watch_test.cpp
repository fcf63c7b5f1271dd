#include "daemon/service/life_watch.hpp"

#include <gtest/gtest.h>

namespace slamd::service {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Two real-time threads and one that may block, looked at ten times a second.
class LifeWatchTest : public testing::Test {
 protected:
  static constexpr Duration kStep = milliseconds(100);

  /// Goes on for so long; threads go round and numbers grow as their rates say.
  void pass(Duration time) {
    for (Duration passed{}; passed < time; passed += kStep) {
      now_ += kStep;
      for (std::size_t i = 0; i < 3; ++i) {
        rounds_[i] += goes_[i] ? 2 : 0;
      }
      flow_.inputs += inputs_a_step_;
      flow_.poses += poses_a_step_;
      sut_.look({{names_[0], false, rounds_[0]},
                 {names_[1], false, rounds_[1]},
                 {names_[2], true, rounds_[2]}},
                flow_,
                now_);
    }
  }

  LifeWatch sut_;
  Stamp now_ = Stamp{} + seconds(1000);
  std::string names_[3] = {"slamd-odometry", "slamd-receive", "slamd-serial"};
  bool goes_[3] = {true, true, true};
  std::uint64_t rounds_[3] = {0, 0, 0};
  Flow flow_;
  std::uint64_t inputs_a_step_ = 0;
  std::uint64_t poses_a_step_ = 0;
};

TEST_F(LifeWatchTest, LivesWhileEachThreadGoesRound) {
  pass(seconds(60));

  EXPECT_TRUE(sut_.lives());
  EXPECT_EQ(sut_.fault(), "");
}

TEST_F(LifeWatchTest, NamesTheThreadThatHangs) {
  pass(seconds(5));
  goes_[1] = false;

  pass(milliseconds(1000));
  EXPECT_TRUE(sut_.lives());
  pass(milliseconds(200));

  EXPECT_EQ(sut_.fault(), "slamd-receive hangs");
}

TEST_F(LifeWatchTest, NoticesAThreadThatHasNeverGoneRound) {
  goes_[0] = false;

  pass(milliseconds(1200));

  EXPECT_EQ(sut_.fault(), "slamd-odometry hangs");
}

TEST_F(LifeWatchTest, LivesAgainWhenTheThreadGoesOn) {
  goes_[0] = goes_[1] = false;
  pass(seconds(2));
  EXPECT_EQ(sut_.fault(), "slamd-odometry hangs, slamd-receive hangs");

  goes_[0] = goes_[1] = true;
  pass(kStep);

  EXPECT_TRUE(sut_.lives());
}

TEST_F(LifeWatchTest, LetsAThreadThatMayBlockTakeAMinute) {
  goes_[2] = false;

  pass(seconds(59));
  EXPECT_TRUE(sut_.lives());
  pass(seconds(2));

  EXPECT_EQ(sut_.fault(), "slamd-serial hangs");
}

TEST_F(LifeWatchTest, WantsPosesWhileInputFlows) {
  flow_.poses_expected = true;
  inputs_a_step_ = poses_a_step_ = 20;
  pass(seconds(10));
  poses_a_step_ = 0;

  pass(milliseconds(2900));
  EXPECT_TRUE(sut_.lives());
  pass(milliseconds(300));

  EXPECT_EQ(sut_.fault(), "input flows, but no pose comes");
}

TEST_F(LifeWatchTest, WantsNoPosesWhenTheCableIsOut) {
  flow_.poses_expected = true;
  inputs_a_step_ = poses_a_step_ = 20;
  pass(seconds(10));

  inputs_a_step_ = poses_a_step_ = 0;
  pass(seconds(600));

  EXPECT_TRUE(sut_.lives());
}

TEST_F(LifeWatchTest, GivesPosesTimeWhenInputFlowsAgain) {
  flow_.poses_expected = true;
  inputs_a_step_ = poses_a_step_ = 20;
  pass(seconds(10));
  inputs_a_step_ = poses_a_step_ = 0;
  pass(seconds(60));

  inputs_a_step_ = 20;
  pass(milliseconds(2500));
  EXPECT_TRUE(sut_.lives());
  pass(milliseconds(1000));

  EXPECT_FALSE(sut_.lives());
}

TEST_F(LifeWatchTest, WantsNoPosesBeforeOdomHasBegun) {
  inputs_a_step_ = 20;

  pass(seconds(600));

  EXPECT_TRUE(sut_.lives());
}

}  // namespace
}  // namespace slamd::service
