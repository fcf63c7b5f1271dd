#include "core/base/bounded_vector.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numeric>

#include "tests/support/allocation_guard.hpp"

namespace slamd {
namespace {

TEST(BoundedVector, HoldsUpToItsCapacity) {
  BoundedVector<int> sut(2);

  EXPECT_TRUE(sut.try_push_back(1));
  EXPECT_TRUE(sut.try_push_back(2));
  EXPECT_FALSE(sut.try_push_back(3));

  EXPECT_TRUE(sut.full());
  EXPECT_EQ(sut.size(), 2U);
  EXPECT_EQ(sut.capacity(), 2U);
  EXPECT_EQ(std::accumulate(sut.begin(), sut.end(), 0), 3);
  EXPECT_EQ(sut.back(), 2);
}

TEST(BoundedVector, GoingPastTheCapacityIsAProgrammerError) {
  BoundedVector<int> sut(2);
  const std::array<int, 3> three{1, 2, 3};
  sut.resize(2);

  EXPECT_DEATH(sut.push_back(1), "assertion failed");
  EXPECT_DEATH(sut.resize(3), "assertion failed");
  EXPECT_DEATH(sut.assign(three), "assertion failed");
}

TEST(BoundedVector, AssignCopiesValuesAndKeepsTheCapacity) {
  const std::array<int, 2> values{7, 8};
  BoundedVector<int> sut(5);
  sut.resize(4);

  sut.assign(values);

  EXPECT_EQ(sut.size(), 2U);
  EXPECT_EQ(sut.capacity(), 5U);
  EXPECT_EQ(sut[1], 8);
}

TEST(BoundedVector, ResizeFillsWithFreshValues) {
  BoundedVector<int> sut(3);
  sut.push_back(1);
  sut.push_back(2);

  sut.resize(1);
  sut.resize(3);

  EXPECT_EQ(sut[0], 1);
  EXPECT_EQ(sut[1], 0);
}

TEST(BoundedVector, WithoutCapacityTakesNothing) {
  BoundedVector<int> sut;

  EXPECT_FALSE(sut.try_push_back(1));
  EXPECT_TRUE(sut.empty());
}

TEST(BoundedVector, DoesNotAllocateAfterConstruction) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  BoundedVector<int> sut(100);
  const BoundedVector<int> other = [] {
    BoundedVector<int> filled(100);
    filled.resize(100);
    return filled;
  }();

  const std::size_t allocations = support::count_allocations([&] {
    for (int i = 0; i < 200; ++i) {
      sut.try_push_back(i);
    }
    sut.clear();
    sut.resize(50);
    sut.assign(other.view());
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(sut.size(), 100U);
}

}  // namespace
}  // namespace slamd
