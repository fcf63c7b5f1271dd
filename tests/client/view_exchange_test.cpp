#include "client/view_exchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

namespace slamd::client {
namespace {

struct Words {
  std::array<int, 64> words{};

  bool is_whole() const { return std::all_of(words.begin(), words.end(), [this](int word) { return word == words[0]; }); }
};

TEST(ViewExchange, ShowsTheNewestAndLetsBeWhatIsLookedAt) {
  ViewExchange<Words> sut;
  const auto first = sut.read();
  sut.begin()->words.fill(1);
  sut.publish();
  const auto second = sut.read();
  sut.begin()->words.fill(2);
  sut.publish();

  EXPECT_EQ(first->words[0], 0);
  EXPECT_EQ(second->words[0], 1);
  EXPECT_EQ(sut.read()->words[0], 2);
}

TEST(ViewExchange, KeepsWhatItShowsWhereAllAreHeld) {
  ViewExchange<Words> sut;
  std::vector<ViewExchange<Words>::Reader> held;
  for (int i = 1; i < static_cast<int>(ViewExchange<Words>::kObjects); ++i) {
    held.push_back(sut.read());
    sut.begin()->words.fill(i);
    sut.publish();
  }
  held.push_back(sut.read());

  EXPECT_EQ(sut.begin(), nullptr);
  EXPECT_EQ(sut.read()->words[0], 4);
  held.erase(held.begin());
  EXPECT_NE(sut.begin(), nullptr);
}

TEST(ViewExchange, GivesReadersOfAnyThreadWholeViewsThatNeverGoBack) {
  ViewExchange<Words> sut;
  std::atomic<bool> done{false};
  std::atomic<int> faults{0};
  const auto look = [&] {
    int last = 0;
    while (!done.load()) {
      const auto view = sut.read();
      faults += view->is_whole() && view->words[0] >= last ? 0 : 1;
      last = view->words[0];
    }
  };
  std::thread one(look);
  std::thread two(look);
  for (int i = 1; i <= 20'000; ++i) {
    if (Words* words = sut.begin(); words != nullptr) {
      words->words.fill(i);
      sut.publish();
    }
  }
  done = true;
  one.join();
  two.join();

  EXPECT_EQ(faults.load(), 0);
}

}  // namespace
}  // namespace slamd::client
