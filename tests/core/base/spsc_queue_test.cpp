#include "core/base/spsc_queue.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "tests/support/allocation_guard.hpp"

namespace slamd {
namespace {

TEST(SpscQueue, PopReturnsNothingWhenEmpty) {
  SpscQueue<int> sut(2);

  EXPECT_FALSE(sut.try_pop());
  EXPECT_TRUE(sut.empty());
}

TEST(SpscQueue, GivesValuesInOrder) {
  SpscQueue<int> sut(3);

  EXPECT_TRUE(sut.try_push(1));
  EXPECT_TRUE(sut.try_push(2));

  EXPECT_EQ(sut.try_pop(), 1);
  EXPECT_EQ(sut.try_pop(), 2);
  EXPECT_FALSE(sut.try_pop());
}

TEST(SpscQueue, RefusesWhenFullAndTakesAgainAfterAPop) {
  SpscQueue<int> sut(2);
  EXPECT_TRUE(sut.try_push(1));
  EXPECT_TRUE(sut.try_push(2));

  EXPECT_FALSE(sut.try_push(3));
  EXPECT_EQ(sut.size(), 2U);
  EXPECT_EQ(sut.try_pop(), 1);
  EXPECT_TRUE(sut.try_push(3));
  EXPECT_FALSE(sut.try_push(4));

  EXPECT_EQ(sut.try_pop(), 2);
  EXPECT_EQ(sut.try_pop(), 3);
}

TEST(SpscQueue, HoldsExactlyItsCapacityAtEveryPositionOfTheRing) {
  for (std::size_t capacity = 1; capacity < 6; ++capacity) {
    SpscQueue<std::size_t> sut(capacity);
    for (std::size_t round = 0; round < 20; ++round) {
      for (std::size_t i = 0; i < capacity; ++i) {
        ASSERT_TRUE(sut.try_push(round + i));
        ASSERT_EQ(sut.size(), i + 1);
      }
      ASSERT_FALSE(sut.try_push(std::size_t{0}));
      for (std::size_t i = 0; i < capacity; ++i) {
        ASSERT_EQ(sut.try_pop(), round + i);
      }
      ASSERT_TRUE(sut.empty());
    }
  }
}

TEST(SpscQueue, MovesValuesAndLeavesARefusedOneAlone) {
  SpscQueue<std::unique_ptr<int>> sut(1);
  auto refused = std::make_unique<int>(2);

  EXPECT_TRUE(sut.try_push(std::make_unique<int>(1)));
  EXPECT_FALSE(sut.try_push(std::move(refused)));

  // NOLINTNEXTLINE(bugprone-use-after-move): that a refused value stays is what is tested
  ASSERT_NE(refused, nullptr);
  const auto popped = sut.try_pop();
  ASSERT_TRUE(popped);
  EXPECT_EQ(**popped, 1);
}

TEST(SpscQueue, HandsEveryValueToTheOtherThreadOnceAndInOrder) {
  constexpr std::uint64_t kValues = 100'000;

  struct Value {
    std::uint64_t number = 0;
    std::uint64_t twice = 0;
  };

  SpscQueue<Value> sut(37);
  std::thread producer([&sut] {
    for (std::uint64_t i = 0; i < kValues;) {
      if (sut.try_push(Value{i, 2 * i})) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });

  std::uint64_t wrong = 0;
  for (std::uint64_t expected = 0; expected < kValues;) {
    if (const auto value = sut.try_pop()) {
      wrong += value->number != expected || value->twice != 2 * expected ? 1 : 0;
      ++expected;
    } else {
      std::this_thread::yield();
    }
  }
  producer.join();

  EXPECT_EQ(wrong, 0U);
  EXPECT_TRUE(sut.empty());
}

TEST(SpscQueue, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  SpscQueue<int> sut(8);
  int popped = 0;

  const std::size_t allocations = support::count_allocations([&] {
    for (int i = 0; i < 100; ++i) {
      sut.try_push(i);
      sut.try_push(i);
      popped += sut.try_pop() ? 1 : 0;
    }
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(popped, 100);
}

}  // namespace
}  // namespace slamd
