#include "core/base/pool.hpp"

#include <gtest/gtest.h>

#include <set>
#include <thread>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace slamd {
namespace {

struct Block {
  Block(int first, double second) : a(first), b(second) {}

  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  int a;
  double b;
};

TEST(Pool, ConstructsEachObjectFromTheSameArguments) {
  Pool<Block> sut(3, 7, 0.5);

  const auto handle = sut.acquire();

  ASSERT_TRUE(handle);
  EXPECT_EQ(handle->a, 7);
  EXPECT_EQ((*handle).b, 0.5);
  EXPECT_EQ(sut.size(), 3U);
}

TEST(Pool, LendsEachObjectOnceAndCountsWhenNoneIsLeft) {
  Pool<int> sut(3, 0);
  std::vector<Pool<int>::Handle> handles;
  std::set<int*> objects;

  for (int i = 0; i < 3; ++i) {
    handles.push_back(sut.acquire());
    objects.insert(handles.back().get());
  }

  EXPECT_EQ(objects.size(), 3U);
  EXPECT_FALSE(sut.acquire());
  EXPECT_FALSE(sut.acquire());
  EXPECT_EQ(sut.exhausted(), 2U);
  EXPECT_EQ(sut.low_water(), 0U);
}

TEST(Pool, LendsAgainWhatWasReleasedOrPutBack) {
  Pool<int> sut(1, 0);

  for (int i = 0; i < 10; ++i) {
    auto released = sut.acquire();
    ASSERT_TRUE(released);
    *released = i;
    released.reset();
    EXPECT_FALSE(released);
    EXPECT_EQ(released.get(), nullptr);

    auto put_back = sut.acquire();
    ASSERT_TRUE(put_back);
    EXPECT_EQ(*put_back, i);
    sut.put_back(std::move(put_back));
  }

  EXPECT_EQ(sut.exhausted(), 0U);
}

TEST(Pool, RemembersTheFewestThatWereFree) {
  Pool<int> sut(5, 0);
  EXPECT_EQ(sut.low_water(), 5U);

  {
    const auto a = sut.acquire();
    const auto b = sut.acquire();
    EXPECT_EQ(sut.low_water(), 3U);
  }
  const auto c = sut.acquire();

  EXPECT_EQ(sut.low_water(), 3U);
}

TEST(Pool, MovingAHandleMovesTheLoan) {
  Pool<int> sut(2, 0);
  auto a = sut.acquire();
  auto b = sut.acquire();
  int* const object = a.get();

  b = std::move(a);

  EXPECT_EQ(b.get(), object);
  EXPECT_TRUE(sut.acquire());  // what b held before is free
  EXPECT_EQ(sut.exhausted(), 0U);
}

TEST(Pool, HandlesTravelThroughAQueueToTheThreadThatReleasesThem) {
  constexpr int kLoans = 20'000;
  constexpr std::size_t kObjects = 4;

  struct Pair {
    int a = 0;
    int b = 0;
  };

  Pool<Pair> sut(kObjects);
  SpscQueue<Pool<Pair>::Handle> queue(kObjects);
  int wrong = 0;
  std::thread releaser([&queue, &wrong] {
    for (int expected = 0; expected < kLoans;) {
      if (auto handle = queue.try_pop()) {
        wrong += (*handle)->a != expected || (*handle)->b != -expected ? 1 : 0;
        ++expected;
      } else {
        std::this_thread::yield();
      }
    }
  });

  for (int i = 0; i < kLoans;) {
    auto handle = sut.acquire();
    if (!handle) {
      std::this_thread::yield();
      continue;
    }
    if (i % 7 == 0) {
      sut.put_back(std::move(handle));
      handle = sut.acquire();
    }
    handle->a = i;
    handle->b = -i;
    ASSERT_TRUE(queue.try_push(std::move(handle)));  // as long as the pool: never full
    ++i;
  }
  releaser.join();

  EXPECT_EQ(wrong, 0);
  EXPECT_LT(sut.low_water(), kObjects);
}

TEST(Pool, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Pool<int> sut(4, 0);
  int lent = 0;

  const std::size_t allocations = support::count_allocations([&] {
    for (int i = 0; i < 100; ++i) {
      const auto a = sut.acquire();
      auto b = sut.acquire();
      lent += (a ? 1 : 0) + (b ? 1 : 0);
      sut.put_back(std::move(b));
    }
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(lent, 200);
}

}  // namespace
}  // namespace slamd
