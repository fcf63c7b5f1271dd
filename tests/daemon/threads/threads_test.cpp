#include <atomic>
#include <chrono>

#include <gtest/gtest.h>

#include "daemon/threads/event_ring.hpp"
#include "daemon/threads/real_time_thread.hpp"
#include "daemon/threads/stage_monitor.hpp"
#include "daemon/threads/wake_up.hpp"

namespace slamd::threads {
namespace {

Stamp at_ms(int ms) { return Stamp{} + std::chrono::milliseconds(ms); }

TEST(WakeUp, RemembersANotificationThatCameBeforeTheWait) {
  WakeUp sut;
  sut.notify();

  const auto begin = std::chrono::steady_clock::now();
  sut.wait(std::chrono::seconds(20));

  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(WakeUp, WakesASleepingThread) {
  WakeUp sut;
  std::atomic<bool> awake{false};
  {
    const RealTimeThread sleeper("sleeper", {}, [&] {
      sut.wait(std::chrono::seconds(60));
      awake = true;
    });

    sut.notify();
  }
  EXPECT_TRUE(awake);
}

TEST(RealTimeThread, RunsItsBodyAndIsJoinedByItsDestructor) {
  std::atomic<int> runs{0};
  { const RealTimeThread sut("runner", {}, [&] { ++runs; }); }
  EXPECT_EQ(runs, 1);
}

TEST(RealTimeThread, HasASmallStack) {
  std::size_t stack_bytes = 0;
  {
    const RealTimeThread sut("small", {}, [&] {
      pthread_attr_t attributes;
      pthread_getattr_np(pthread_self(), &attributes);
      pthread_attr_getstacksize(&attributes, &stack_bytes);
      pthread_attr_destroy(&attributes);
    });
  }
  EXPECT_EQ(stack_bytes, RealTimeThread::kStackBytes);
}

TEST(StageMonitor, ShowsThePeriodThatIsOver) {
  StageMonitor sut;
  sut.add(std::chrono::milliseconds(1), at_ms(5000));
  sut.add(std::chrono::milliseconds(3), at_ms(5001));
  EXPECT_EQ(sut.last_period().count, 0U);

  sut.add(std::chrono::milliseconds(9), at_ms(7500));

  EXPECT_EQ(sut.last_period().count, 2U);
  EXPECT_EQ(sut.last_period().max, std::chrono::milliseconds(3));
  EXPECT_EQ(sut.total().count, 2U);
}

TEST(EventRing, DropsTheNewestWhenFullAndCountsIt) {
  EventRing sut(2);
  sut.write(at_ms(1), Event::kLidarHeard, 7);
  sut.write(at_ms(2), Event::kImuHeard);
  sut.write(at_ms(3), Event::kLidarSilent);

  const auto first = sut.try_read();
  const auto second = sut.try_read();

  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->event, Event::kLidarHeard);
  EXPECT_EQ(first->value, 7U);
  EXPECT_EQ(second->event, Event::kImuHeard);
  EXPECT_FALSE(sut.try_read());
  EXPECT_EQ(sut.dropped(), 1U);
}

}  // namespace
}  // namespace slamd::threads
