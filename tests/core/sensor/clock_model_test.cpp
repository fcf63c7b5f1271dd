#include "core/sensor/clock_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace slamd::sensor {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr Stamp kStart{seconds{1'700'000'000}};

double microseconds_of(Duration duration) {
  return to_seconds(duration) * 1e6;
}

// A device that sends at a fixed rate over a network that delivers in order.
struct Device {
  std::mt19937 random{1};
  Duration interval = microseconds{1327};  // on the time base
  double drift = 0.0;                      // rate of the device's clock, minus 1
  Duration origin = hours{5};              // the device's clock at kStart
  Duration latency = microseconds{300};    // the least
  double jitter_s = 0.0;                   // mean of what comes on top, exponential
  Duration roll_over{};

  Duration elapsed{};  // on the time base, since kStart
  Stamp stalled_until{};
  Stamp last_arrival{};

  struct Packet {
    DeviceStamp device{};
    Stamp arrival{};
    Stamp truth{};  // of what the model shall find: the time sent plus the least latency
  };

  Packet next() {
    Packet packet;
    Duration device = origin + elapsed + from_seconds(to_seconds(elapsed) * drift);
    if (roll_over > Duration::zero()) {
      device = ((device % roll_over) + roll_over) % roll_over;
    }
    packet.device = DeviceStamp{device};
    packet.truth = kStart + elapsed + latency;
    packet.arrival = packet.truth;
    if (jitter_s > 0.0) {
      packet.arrival += from_seconds(std::exponential_distribution<double>(1.0 / jitter_s)(random));
    }
    packet.arrival = std::max({packet.arrival, stalled_until, last_arrival});
    last_arrival = packet.arrival;
    elapsed += interval;
    return packet;
  }
};

// Runs a device through the model and returns the largest error after settling, in µs; checks what
// must hold for packets in order: the mapped time increases, and after settling intervals are true
// within 1e-3.
double largest_error_us(ClockModel& sut, Device& device, Duration duration, Duration settling) {
  double largest = 0.0;
  const Duration begin = device.elapsed;
  Stamp last_mapped{};
  Stamp last_truth{};
  while (device.elapsed < begin + duration) {
    const auto packet = device.next();
    const Stamp mapped = sut.map(packet.device, packet.arrival);
    if (last_truth != Stamp{}) {
      EXPECT_GT(mapped, last_mapped);
    }
    if (device.elapsed > begin + settling) {
      largest = std::max(largest, std::abs(microseconds_of(mapped - packet.truth)));
      if (last_truth != Stamp{}) {
        const double ratio =
            to_seconds(mapped - last_mapped) / to_seconds(packet.truth - last_truth);
        EXPECT_NEAR(ratio, 1.0, 1e-3);
      }
    }
    last_mapped = mapped;
    last_truth = packet.truth;
  }
  return largest;
}

TEST(ClockModel, FirstStampMapsToItsArrival) {
  ClockModel sut(ClockConfig{});

  EXPECT_EQ(sut.map(DeviceStamp{seconds{7}}, kStart), kStart);
}

TEST(ClockModel, PerfectDeviceIsMappedExactly) {
  ClockModel sut(ClockConfig{});
  Device device;

  EXPECT_LT(largest_error_us(sut, device, seconds{5}, Duration::zero()), 0.01);
}

TEST(ClockModel, FindsDriftUnderJitterWithinTwoSeconds) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Device device;
    device.random.seed(seed);
    const auto uniform = [&device](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(device.random);
    };
    device.interval = from_seconds(uniform(0.0004, 0.005));
    device.drift = uniform(-100e-6, 100e-6);
    device.origin = from_seconds(uniform(-1e6, 1e6));
    device.latency = from_seconds(uniform(0.0, 0.002));
    device.jitter_s = uniform(0.0, 0.002);
    ClockModel sut(ClockConfig{});

    EXPECT_LT(largest_error_us(sut, device, seconds{20}, seconds{2}), 200.0);
    EXPECT_NEAR(sut.health().skew, -device.drift, 20e-6);
    EXPECT_EQ(sut.health().steps, 0U);
    EXPECT_EQ(sut.health().strays, 0U);
  }
}

TEST(ClockModel, StallsOfTensOfMillisecondsDoNotMoveTheMapping) {
  ClockModel sut(ClockConfig{});
  Device device;
  device.drift = 60e-6;
  device.jitter_s = 0.0005;
  largest_error_us(sut, device, seconds{4}, seconds{4});

  for (int i = 0; i < 30; ++i) {
    device.stalled_until = kStart + device.elapsed + milliseconds{10 + 3 * i};
    EXPECT_LT(largest_error_us(sut, device, milliseconds{150 + 7 * i}, Duration::zero()), 200.0);
  }

  EXPECT_EQ(sut.health().steps, 0U);
}

TEST(ClockModel, LongCongestionDoesNotMoveTheMapping) {
  ClockModel sut(ClockConfig{});
  Device device;
  largest_error_us(sut, device, seconds{13}, seconds{13});

  const Stamp congested_until = kStart + device.elapsed + seconds{3};
  while (kStart + device.elapsed < congested_until) {
    auto packet = device.next();
    packet.arrival += milliseconds{40};
    EXPECT_LT(std::abs(microseconds_of(sut.map(packet.device, packet.arrival) - packet.truth)),
              200.0);
  }

  EXPECT_EQ(sut.health().steps, 0U);
}

TEST(ClockModel, LateFirstPacketIsCaughtUpWithoutAJump) {
  ClockModel sut(ClockConfig{});
  Device device;
  device.drift = -80e-6;
  device.stalled_until = kStart + milliseconds{25};

  EXPECT_LT(largest_error_us(sut, device, seconds{10}, seconds{2}), 200.0);
  EXPECT_EQ(sut.health().steps, 0U);
}

TEST(ClockModel, NeverRunsFasterOrSlowerThanItsSlewAllows) {
  ClockModel sut(ClockConfig{});
  Device device;
  device.jitter_s = 0.004;
  device.stalled_until = kStart + milliseconds{30};
  Stamp last{};

  for (int i = 0; i < 10'000; ++i) {
    const auto packet = device.next();
    const Stamp mapped = sut.map(packet.device, packet.arrival);
    if (i > 0) {
      const double ratio = to_seconds(mapped - last) / to_seconds(device.interval);
      ASSERT_NEAR(ratio, 1.0, ClockModel::kAcquisitionSlew + ClockModel::kMaxSkew + 1e-6);
    }
    last = mapped;
  }
}

TEST(ClockModel, FollowsStepsBothWays) {
  for (const auto jump : {milliseconds{3'600'000},
                          milliseconds{2000},
                          milliseconds{150},
                          milliseconds{60},
                          milliseconds{-60},
                          milliseconds{-150},
                          milliseconds{-2000},
                          milliseconds{-3'600'000}}) {
    SCOPED_TRACE(jump.count());
    ClockModel sut(ClockConfig{});
    Device device;
    device.drift = 50e-6;
    device.jitter_s = 0.0005;
    largest_error_us(sut, device, seconds{5}, seconds{5});
    const double skew_before = sut.health().skew;

    device.origin += jump;
    for (int i = 0; i < 150; ++i) {
      const auto packet = device.next();
      sut.map(packet.device, packet.arrival);
    }

    EXPECT_EQ(sut.health().steps, 1U);
    EXPECT_NEAR(to_seconds(sut.health().last_step), to_seconds(jump), 0.003);
    EXPECT_NEAR(sut.health().skew, skew_before, 1e-12);
    EXPECT_LT(largest_error_us(sut, device, seconds{10}, seconds{2}), 200.0);
    EXPECT_EQ(sut.health().steps, 1U);
  }
}

TEST(ClockModel, MapsAForwardStepToItsArrivalAtOnceSoThatTimeGoesOn) {
  ClockModel sut(ClockConfig{});
  Device device;
  device.jitter_s = 0.0005;
  largest_error_us(sut, device, seconds{5}, seconds{5});

  device.origin += seconds{100};
  Stamp last{};
  for (int i = 0; i < 2000; ++i) {
    const auto packet = device.next();
    const Stamp mapped = sut.map(packet.device, packet.arrival);
    EXPECT_LT(std::abs(microseconds_of(mapped - packet.truth)), 5000.0);
    EXPECT_GT(mapped, last);
    last = mapped;
  }

  EXPECT_EQ(sut.health().steps, 1U);
}

TEST(ClockModel, FollowsARestartDuringAnOutage) {
  ClockModel sut(ClockConfig{.roll_over = hours{1}});
  Device device;
  device.roll_over = hours{1};
  device.origin = minutes{20};
  largest_error_us(sut, device, seconds{5}, seconds{5});

  device.elapsed += seconds{40};
  device.origin = minutes{20} - seconds{30};  // 10 s more than when it was last heard
  for (int i = 0; i < 1000; ++i) {
    const auto packet = device.next();
    sut.map(packet.device, packet.arrival);
  }

  EXPECT_EQ(sut.health().steps, 1U);
  EXPECT_LT(largest_error_us(sut, device, seconds{5}, seconds{2}), 200.0);
}

TEST(ClockModel, FollowsASmallBackwardStepThatLooksLikeLatencyAfterTheWindow) {
  ClockModel sut(ClockConfig{});
  Device device;
  device.interval = milliseconds{50};
  largest_error_us(sut, device, seconds{14}, seconds{14});

  device.origin -= milliseconds{30};  // less than an interval: no stamp goes back
  while (sut.health().steps == 0 && device.elapsed < minutes{1}) {
    const auto packet = device.next();
    sut.map(packet.device, packet.arrival);
  }

  EXPECT_LT(device.elapsed, seconds{30});
  EXPECT_LT(largest_error_us(sut, device, seconds{5}, seconds{2}), 200.0);
}

TEST(ClockModel, StrayStampsAreNoSteps) {
  ClockModel sut(ClockConfig{});
  Device device;
  largest_error_us(sut, device, seconds{5}, seconds{5});

  for (int i = 0; i < 20; ++i) {
    const auto packet = device.next();
    const Duration stray = i % 2 == 0 ? Duration{hours{3}} : Duration{-hours{3}};
    sut.map(packet.device + stray, packet.arrival);
    EXPECT_LT(largest_error_us(sut, device, milliseconds{100}, Duration::zero()), 200.0);
  }

  EXPECT_EQ(sut.health().steps, 0U);
  EXPECT_EQ(sut.health().strays, 10U);
}

TEST(ClockModel, SurvivesAny64BitsAsAStamp) {
  for (const auto kind : {ClockKind::kShared, ClockKind::kEstimated}) {
    for (const auto roll_over : {Duration::zero(), Duration{hours{1}}}) {
      ClockModel sut(ClockConfig{.kind = kind, .roll_over = roll_over});
      std::mt19937_64 random(5);
      Stamp arrival = kStart;
      for (int i = 0; i < 10'000; ++i) {
        arrival += microseconds{500};
        const auto bits = static_cast<std::int64_t>(random());
        sut.map(DeviceStamp{Duration{i % 3 == 0 ? bits : bits >> 20}}, arrival);
      }
      sut.map(DeviceStamp{Duration{std::numeric_limits<std::int64_t>::min()}}, arrival);
      sut.map(DeviceStamp{Duration{std::numeric_limits<std::int64_t>::max()}}, arrival);
      EXPECT_EQ(sut.health().stamps, 10'002U);
    }
  }
}

TEST(ClockModel, DuplicatesAndReorderedPacketsMapToWhatTheyShould) {
  ClockModel sut(ClockConfig{});
  Device device;
  device.drift = 70e-6;
  device.jitter_s = 0.0003;
  largest_error_us(sut, device, seconds{5}, seconds{5});

  for (int i = 0; i < 2000; ++i) {
    const auto first = device.next();
    const auto second = device.next();
    const Stamp mapped_second = sut.map(second.device, second.arrival);
    const Stamp mapped_first = sut.map(first.device, second.arrival);
    const Stamp again = sut.map(second.device, second.arrival + milliseconds{1});
    EXPECT_LT(std::abs(microseconds_of(mapped_first - first.truth)), 200.0);
    EXPECT_LT(std::abs(microseconds_of(mapped_second - second.truth)), 200.0);
    EXPECT_LT(mapped_first, mapped_second);
    EXPECT_EQ(again, mapped_second);
  }

  EXPECT_EQ(sut.health().out_of_order, 4000U);
  EXPECT_EQ(sut.health().steps, 0U);
}

TEST(ClockModel, GoesOnOverTheRollOver) {
  ClockModel sut(ClockConfig{.roll_over = hours{1}});
  Device device;
  device.roll_over = hours{1};
  device.origin = hours{1} - seconds{5};
  device.drift = 30e-6;
  device.jitter_s = 0.0005;

  EXPECT_LT(largest_error_us(sut, device, seconds{20}, seconds{2}), 200.0);
  EXPECT_EQ(sut.health().roll_overs, 1U);
  EXPECT_EQ(sut.health().steps, 0U);
}

TEST(ClockModel, FollowsADeviceThatFindsItsPpsAndThenTheDate) {
  ClockModel sut(ClockConfig{});
  Device device;
  device.drift = 30e-6;
  device.jitter_s = 0.0005;
  EXPECT_LT(largest_error_us(sut, device, seconds{10}, seconds{2}), 200.0);

  sut.set_roll_over(seconds{1});
  device.roll_over = seconds{1};
  device.origin += milliseconds{300};
  EXPECT_LT(largest_error_us(sut, device, seconds{10}, seconds{2}), 200.0);
  EXPECT_EQ(sut.health().steps, 1U);
  EXPECT_GE(sut.health().roll_overs, 9U);

  sut.set_roll_over({});
  device.roll_over = {};
  device.origin = kStart.time_since_epoch();
  EXPECT_LT(largest_error_us(sut, device, seconds{10}, seconds{2}), 200.0);
  EXPECT_EQ(sut.health().steps, 2U);
}

TEST(ClockModel, PacketFromBeforeTheRollOverThatComesLateIsPutBeforeIt) {
  ClockModel sut(ClockConfig{.roll_over = hours{1}});
  sut.map(DeviceStamp{hours{1} - milliseconds{2}}, kStart);

  const Stamp after = sut.map(DeviceStamp{milliseconds{1}}, kStart + milliseconds{3});
  const Stamp before = sut.map(DeviceStamp{hours{1} - milliseconds{1}}, kStart + milliseconds{4});

  EXPECT_EQ(after, kStart + milliseconds{3});
  EXPECT_EQ(before, kStart + milliseconds{1});
  EXPECT_EQ(sut.health().roll_overs, 1U);
}

TEST(ClockModel, ComesBackAfterAnOutageOfHours) {
  ClockModel sut(ClockConfig{.roll_over = hours{1}});
  Device device;
  device.roll_over = hours{1};
  largest_error_us(sut, device, seconds{20}, seconds{20});

  device.elapsed += hours{2} + minutes{20};

  EXPECT_LT(largest_error_us(sut, device, seconds{20}, seconds{3}), 200.0);
}

TEST(ClockModel, SharedClockPassesThrough) {
  ClockModel sut(ClockConfig{.kind = ClockKind::kShared});
  const DeviceStamp device{kStart.time_since_epoch()};

  EXPECT_EQ(sut.map(device, kStart + milliseconds{1}), kStart);
  EXPECT_EQ(sut.map(device + milliseconds{1}, kStart + milliseconds{50}), kStart + milliseconds{1});
  EXPECT_EQ(sut.health().residual_max, milliseconds{49});
  EXPECT_EQ(sut.health().residual_mean, milliseconds{25});
}

TEST(ClockModel, SharedVelodyneClockGetsItsHourFromTheArrival) {
  const Stamp top_of_hour{hours{472'222}};
  ClockModel sut(ClockConfig{.kind = ClockKind::kShared, .roll_over = hours{1}});

  EXPECT_EQ(sut.map(DeviceStamp{minutes{59} + seconds{59}}, top_of_hour + milliseconds{1}),
            top_of_hour - seconds{1});
  EXPECT_EQ(sut.map(DeviceStamp{milliseconds{2}}, top_of_hour + milliseconds{3}),
            top_of_hour + milliseconds{2});
  EXPECT_EQ(sut.map(DeviceStamp{milliseconds{5}}, top_of_hour - milliseconds{1}),
            top_of_hour + milliseconds{5});
  for (int minute = 0; minute < 60; ++minute) {
    const Stamp arrival = top_of_hour + minutes{17};
    const Stamp mapped = sut.map(DeviceStamp{minutes{minute}}, arrival);
    EXPECT_LE(std::chrono::abs(mapped - arrival), minutes{30});
  }
}

TEST(ClockModel, SharedClockIsBelievedOnceADeviceThatHadJustBootedLocksToIt) {
  ClockModel sut(ClockConfig{.kind = ClockKind::kShared});
  for (int i = 0; i < 2000; ++i) {
    const Stamp arrival = kStart + i * milliseconds{2};
    const Duration uptime = seconds{20} + i * milliseconds{2};
    const Stamp mapped = sut.map(DeviceStamp{i < 1000 ? uptime : arrival.time_since_epoch()}, arrival + microseconds{300});
    if (i > 1010) {
      ASSERT_EQ(mapped, arrival) << i;
    }
  }

  EXPECT_EQ(sut.health().taken_off, Duration{});
}

TEST(ClockModel, SharedClockReportsSmallStepsButKeepsPassingThrough) {
  ClockModel sut(ClockConfig{.kind = ClockKind::kShared});
  for (int i = 0; i < 2000; ++i) {
    const Stamp arrival = kStart + i * milliseconds{2};
    const Duration device = arrival.time_since_epoch() + milliseconds{i < 1000 ? 0 : 400};
    EXPECT_EQ(sut.map(DeviceStamp{device}, arrival), Stamp{device});
  }

  EXPECT_EQ(sut.health().steps, 1U);
  EXPECT_EQ(sut.health().last_step, milliseconds{400});
}

TEST(ClockModel, TakesAStepOffASharedClockWithinATenthOfASecondUntilItStepsBack) {
  for (const Duration step : {Duration{hours{1}}, Duration{-hours{24 * 365 * 40}}, Duration{seconds{1}}}) {
    ClockModel sut(ClockConfig{.kind = ClockKind::kShared});
    for (int i = 0; i < 3000; ++i) {
      const Stamp arrival = kStart + i * milliseconds{2};
      const Stamp true_stamp = arrival - microseconds{300};
      const bool stepped = i >= 1000 && i < 2000;
      const Stamp mapped = sut.map(DeviceStamp{true_stamp.time_since_epoch() + (stepped ? step : Duration{})}, arrival);
      if (i < 1000 || i >= 2050) {
        EXPECT_EQ(mapped, true_stamp) << i;
      } else if (i >= 1050 && i < 2000) {
        EXPECT_NEAR(microseconds_of(mapped - true_stamp), 0.0, 50.0) << i;
      }
    }
    EXPECT_EQ(sut.health().steps, 2U);
    EXPECT_EQ(sut.health().taken_off, Duration{});
  }
}

TEST(ClockModel, WildStampsOfASharedClockChangeNothingAfterThem) {
  for (const int wild_at : {0, 1, 1000}) {
    for (const Duration wild : {Duration{hours{1}}, Duration{-hours{1}}}) {
      ClockModel sut(ClockConfig{.kind = ClockKind::kShared});
      for (int i = 0; i < 2000; ++i) {
        const Stamp arrival = kStart + i * milliseconds{2};
        const Duration device = arrival.time_since_epoch() + (i == wild_at ? wild : Duration{});
        EXPECT_EQ(sut.map(DeviceStamp{device}, arrival), Stamp{device}) << wild_at << ' ' << i;
      }
    }
  }
}

TEST(ClockModel, ResidualIsTheJitterAboveTheEnvelope) {
  ClockModel sut(ClockConfig{});
  Device device;
  device.jitter_s = 0.001;
  device.interval =
      milliseconds{20};  // rarer than the jitter is long: in-order delivery adds nothing
  largest_error_us(sut, device, seconds{60}, seconds{60});

  sut.clear_residual();
  largest_error_us(sut, device, seconds{60}, seconds{60});

  EXPECT_NEAR(microseconds_of(sut.health().residual_mean), 1000.0, 150.0);
  EXPECT_GT(sut.health().residual_max, milliseconds{4});
}

TEST(ClockModel, IsDeterministic) {
  ClockModel a(ClockConfig{});
  ClockModel b(ClockConfig{});
  Device device;
  device.drift = 90e-6;
  device.jitter_s = 0.002;

  for (int i = 0; i < 10'000; ++i) {
    const auto packet = device.next();
    ASSERT_EQ(a.map(packet.device, packet.arrival), b.map(packet.device, packet.arrival));
  }
}

TEST(ClockModel, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  ClockModel sut(ClockConfig{});
  Device device;
  device.jitter_s = 0.001;

  const std::size_t allocations = support::count_allocations([&] {
    for (int i = 0; i < 20'000; ++i) {
      if (i % 5000 == 4999) {
        device.origin += i % 2 == 0 ? seconds{1} : -seconds{1};
      }
      const auto packet = device.next();
      sut.map(packet.device, packet.arrival);
    }
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::sensor
