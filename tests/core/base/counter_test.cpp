#include "core/base/counter.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace slamd {
namespace {

TEST(Counter, CountsFromZero) {
  Counter sut;
  EXPECT_EQ(sut.value(), 0U);

  sut.add();
  sut.add(5);

  EXPECT_EQ(sut.value(), 6U);
}

TEST(Counter, NeverGoesBackForAReaderInAnotherThread) {
  constexpr std::uint64_t kEvents = 100'000;
  Counter sut;
  std::thread writer([&sut] {
    for (std::uint64_t i = 0; i < kEvents; ++i) {
      sut.add();
    }
  });

  std::uint64_t last = 0;
  bool went_back = false;
  while (last < kEvents) {
    const std::uint64_t now = sut.value();
    went_back = went_back || now < last;
    last = now;
    std::this_thread::yield();
  }
  writer.join();

  EXPECT_FALSE(went_back);
  EXPECT_EQ(sut.value(), kEvents);
}

}  // namespace
}  // namespace slamd
