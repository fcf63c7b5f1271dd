#include "core/base/latest.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <thread>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace slamd {
namespace {

// Every field says which store it belongs to; 13 bytes beyond a multiple of a word.
struct State {
  std::array<std::uint64_t, 31> numbers{};
  std::array<std::uint8_t, 13> tail{};

  static State of(std::uint64_t number) {
    State state;
    state.numbers.fill(number);
    state.tail.fill(static_cast<std::uint8_t>(number));
    return state;
  }

  bool whole() const {
    for (const std::uint64_t number : numbers) {
      if (number != numbers[0]) {
        return false;
      }
    }
    for (const std::uint8_t byte : tail) {
      if (byte != static_cast<std::uint8_t>(numbers[0])) {
        return false;
      }
    }
    return true;
  }
};

TEST(Latest, IsNothingBeforeTheFirstStore) {
  const Latest<int> sut;

  EXPECT_FALSE(sut.load());
  EXPECT_EQ(sut.version(), 0U);
}

TEST(Latest, ShowsTheNewestValue) {
  Latest<State> sut;

  for (std::uint64_t i = 1; i < 10; ++i) {
    sut.store(State::of(i));
    const auto loaded = sut.load();
    ASSERT_TRUE(loaded);
    EXPECT_EQ(loaded->numbers[30], i);
    EXPECT_TRUE(loaded->whole());
    EXPECT_EQ(sut.version(), i);
  }
}

TEST(Latest, TakesValuesSmallerThanAWord) {
  Latest<char> sut;

  sut.store('x');

  EXPECT_EQ(sut.load(), 'x');
}

TEST(Latest, ReadersNeverSeeATornOrAnOlderValue) {
  constexpr std::uint64_t kStores = 30'000;
  Latest<State> sut;
  std::atomic<std::uint64_t> torn{0};
  std::atomic<std::uint64_t> went_back{0};
  const auto read = [&] {
    std::uint64_t last = 0;
    while (last < kStores) {
      const auto state = sut.load();
      if (!state) {
        std::this_thread::yield();
        continue;
      }
      torn += state->whole() ? 0 : 1;
      went_back += state->numbers[0] < last ? 1 : 0;
      last = state->numbers[0];
    }
  };
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i) {
    readers.emplace_back(read);
  }

  for (std::uint64_t i = 1; i <= kStores; ++i) {
    sut.store(State::of(i));
    if (i % 64 == 0) {
      std::this_thread::yield();
    }
  }
  for (std::thread& reader : readers) {
    reader.join();
  }

  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(went_back, 0U);
}

TEST(Latest, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Latest<State> sut;
  std::uint64_t sum = 0;

  const std::size_t allocations = support::count_allocations([&] {
    for (std::uint64_t i = 1; i <= 100; ++i) {
      sut.store(State::of(i));
      sum += sut.load()->numbers[3];
    }
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(sum, 5050U);
}

}  // namespace
}  // namespace slamd
