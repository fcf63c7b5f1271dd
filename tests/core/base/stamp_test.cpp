#include "core/base/stamp.hpp"

#include <gtest/gtest.h>

#include <concepts>
#include <type_traits>

namespace slamd {
namespace {

template <typename A, typename B>
concept Subtractable = requires(A a, B b) {
  a - b;
};

template <typename A, typename B>
concept Comparable = requires(A a, B b) {
  a < b;
};

using Steady = std::chrono::steady_clock::time_point;
using System = std::chrono::system_clock::time_point;

// The clocks must not mix.
static_assert(Subtractable<Stamp, Stamp> && Subtractable<DeviceStamp, DeviceStamp>);
static_assert(!Subtractable<Stamp, DeviceStamp> && !Subtractable<DeviceStamp, Stamp>);
static_assert(!Subtractable<Stamp, Steady> && !Subtractable<Stamp, System>);
static_assert(!Comparable<Stamp, DeviceStamp> && !Comparable<Stamp, Steady> &&
              !Comparable<Stamp, System>);
static_assert(!std::is_constructible_v<Stamp, DeviceStamp> &&
              !std::is_assignable_v<Stamp&, DeviceStamp>);
static_assert(!std::is_constructible_v<DeviceStamp, Stamp> &&
              !std::is_constructible_v<Stamp, Steady>);
static_assert(!std::is_convertible_v<std::int64_t, Stamp> &&
              !std::is_convertible_v<Duration, Stamp>);
static_assert(!std::is_convertible_v<double, Duration>);
static_assert(std::same_as<decltype(Stamp{} - Stamp{}), Duration>);

TEST(Stamp, ResolvesANanosecondOfUnixTime) {
  const Stamp stamp{Duration{1'700'000'000'123'456'789}};

  EXPECT_EQ((stamp + Duration{1}) - stamp, Duration{1});
  EXPECT_EQ(stamp.time_since_epoch().count(), 1'700'000'000'123'456'789);
}

TEST(Stamp, SecondsRoundToTheNearestNanosecondOnBothSidesOfZero) {
  EXPECT_EQ(from_seconds(1.5e-9), Duration{2});
  EXPECT_EQ(from_seconds(1.4e-9), Duration{1});
  EXPECT_EQ(from_seconds(-1.4e-9), Duration{-1});
  EXPECT_EQ(from_seconds(-1.6e-9), Duration{-2});
  EXPECT_EQ(from_seconds(0.1), std::chrono::milliseconds{100});
  EXPECT_DOUBLE_EQ(to_seconds(std::chrono::milliseconds{-250}), -0.25);
}

}  // namespace
}  // namespace slamd
