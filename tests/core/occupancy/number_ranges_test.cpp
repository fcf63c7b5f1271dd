#include "core/occupancy/number_ranges.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace slamd::occupancy {
namespace {

std::set<std::uint64_t> numbers_in(const NumberRanges& ranges) {
  std::set<std::uint64_t> numbers;
  for (const NumberRange& range : ranges.view()) {
    for (std::uint64_t n = range.from + 1; n <= range.to; ++n) {
      numbers.insert(n);
    }
  }
  return numbers;
}

TEST(NumberRanges, HoldWhatASetHolds) {
  std::mt19937_64 engine(5);
  for (int run = 0; run < 200; ++run) {
    NumberRanges sut;
    std::set<std::uint64_t> expected;
    for (int step = 0; step < 40; ++step) {
      const std::uint64_t from = engine() % 60;
      const NumberRange range{from, from + engine() % 12};
      const bool adds = engine() % 2 == 0;
      adds ? sut.add(range) : sut.remove(range);
      for (std::uint64_t n = range.from + 1; n <= range.to; ++n) {
        adds ? static_cast<void>(expected.insert(n)) : static_cast<void>(expected.erase(n));
      }

      ASSERT_EQ(numbers_in(sut), expected) << "run " << run << ", step " << step;
      for (std::size_t i = 1; i < sut.view().size(); ++i) {
        ASSERT_LT(sut.view()[i - 1].to, sut.view()[i].from);
      }
    }
  }
}

TEST(NumberRanges, LoseNothingWhereThereIsNoRoom) {
  std::mt19937_64 engine(6);
  for (int run = 0; run < 20; ++run) {
    NumberRanges sut;
    std::set<std::uint64_t> expected;
    for (int step = 0; step < 400; ++step) {
      const std::uint64_t from = 3 * (engine() % 300);
      const NumberRange range{from, from + 1};
      const bool adds = engine() % 4 != 0;
      adds ? sut.add(range) : sut.remove(range);
      adds ? static_cast<void>(expected.insert(from + 1)) : static_cast<void>(expected.erase(from + 1));
    }
    const std::set<std::uint64_t> held = numbers_in(sut);
    for (const std::uint64_t n : expected) {
      ASSERT_TRUE(held.contains(n)) << n;
    }
    sut.remove({0, 1000});
    EXPECT_TRUE(sut.empty());
  }
}

TEST(NumberRanges, AreNotSplitWithoutRoom) {
  NumberRanges sut;
  for (std::uint64_t i = 0; i < NumberRanges::kCapacity; ++i) {
    sut.add({10 * i, 10 * i + 5});
  }

  sut.remove({2, 3});

  EXPECT_EQ(sut.view().size(), NumberRanges::kCapacity);
  EXPECT_EQ(sut.view()[0], (NumberRange{0, 5}));
}

}  // namespace
}  // namespace slamd::occupancy
