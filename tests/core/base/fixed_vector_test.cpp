#include "core/base/fixed_vector.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/allocation_guard.hpp"

namespace slamd {
namespace {

TEST(FixedVector, HoldsWhatWasPushedInOrder) {
  FixedVector<int, 4> sut{1, 2};

  sut.push_back(3);

  EXPECT_EQ(sut.size(), 3U);
  EXPECT_EQ(sut[0], 1);
  EXPECT_EQ(sut.back(), 3);
  EXPECT_EQ(std::accumulate(sut.begin(), sut.end(), 0), 6);
  EXPECT_EQ(sut.view().size(), 3U);
  EXPECT_FALSE(sut.full());
}

TEST(FixedVector, RefusesMoreThanItsCapacity) {
  FixedVector<int, 2> sut{1, 2};

  EXPECT_FALSE(sut.try_push_back(3));
  EXPECT_EQ(sut.size(), 2U);
  EXPECT_DEATH(sut.push_back(3), "assertion failed");
  EXPECT_DEATH(sut.resize(3), "assertion failed");
}

TEST(FixedVector, ResizeFillsWithFreshValues) {
  FixedVector<int, 4> sut{1, 2, 3};

  sut.resize(1);
  sut.resize(3);

  EXPECT_EQ(sut[0], 1);
  EXPECT_EQ(sut[1], 0);
  EXPECT_EQ(sut[2], 0);
}

TEST(FixedVector, ClearMakesItEmptyAndPushableAgain) {
  FixedVector<int, 1> sut{1};

  sut.clear();

  EXPECT_TRUE(sut.empty());
  EXPECT_TRUE(sut.try_push_back(2));
}

TEST(FixedVector, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  std::size_t size = 0;

  const std::size_t allocations = support::count_allocations([&size] {
    FixedVector<int, 100> sut;
    for (int i = 0; i < 200; ++i) {
      sut.try_push_back(i);
    }
    size = sut.size();
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(size, 100U);
}

}  // namespace
}  // namespace slamd
