#include "core/occupancy/mirror.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <vector>

#include "core/occupancy/delta_source.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::occupancy {
namespace {

GridConfig small_grid() {
  GridConfig config;
  config.box_m = 9.6;  // 6 blocks
  config.height_m = 3.2;
  config.max_points = 100;
  return config;
}

/// A grid that random scans change, and the messages that come of it.
struct Daemon {
  explicit Daemon(std::uint64_t seed, DeltaConfig config = {}) : engine(seed), source(config, grid) { source.restart(map_id, 1); }

  double any() { return std::uniform_real_distribution<double>(-1.0, 1.0)(engine); }

  void scan() {
    place += Eigen::Vector3d(any(), any(), 0.3 * any());
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 30; ++i) {
      points.emplace_back((Eigen::Vector3d(5.0 * any(), 5.0 * any(), any()) + place).cast<float>());
    }
    CarvingScan scan;
    scan.points_imu = points;
    scan.T_odom_base = geometry::Se3(Eigen::Matrix3d::Identity(), place);
    scan.origin_odom = place;
    grid.insert(scan);
    if (engine() % 10 == 0) {
      const auto submap = static_cast<std::int32_t>(++submaps);
      source.set_anchor(submap, cell_of(place, 0.2).block());
      grid.set_submap(submap);
    }
  }

  void restart() {
    grid.restart(place);
    source.restart(++map_id, 1);
  }

  /// Calls send(message) for each message of an update.
  template <typename Send>
  void tell(Send&& send) {
    source.begin(Stamp{});
    DeltaKind kind{};
    while (source.next(message, kind)) {
      ASSERT_TRUE(is_well_formed(message));
      send(message, kind);
    }
  }

  std::mt19937_64 engine;
  RollingGrid grid{small_grid()};
  DeltaSource source;
  std::int64_t map_id = 1;
  std::uint64_t submaps = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  MapDelta message;
};

/// What a mirror says of itself holds.
void expect_truth(const Mirror& mirror, const Daemon& daemon) {
  if (mirror.map_id() != daemon.map_id || mirror.newest() != daemon.grid.changes().newest()) {
    return;
  }
  ASSERT_EQ(mirror.map().window(), daemon.grid.states().window());
  for (std::uint32_t slot = 0; slot < mirror.map().size(); ++slot) {
    if (mirror.is_current(slot)) {
      ASSERT_EQ(mirror.map().block(slot), daemon.grid.states().block(slot)) << "slot " << slot;
      ASSERT_EQ(mirror.number(slot), daemon.grid.changes().number(slot));
      ASSERT_EQ(mirror.submap(slot), daemon.grid.submap(slot));
    }
  }
  if (mirror.complete()) {
    ASSERT_EQ(mirror.digest(), daemon.grid.digest());
  }
}

/// SLAMD_SEEDS=2000 tries more.
TEST(Mirror, EqualsTheMapAfterAnyLossDuplicationReorderingAndRestarts) {
  const char* wanted = std::getenv("SLAMD_SEEDS");
  const int seeds = wanted != nullptr ? std::atoi(wanted) : 50;
  for (int seed = 0; seed < seeds; ++seed) {
    Daemon daemon(static_cast<std::uint64_t>(seed));
    std::mt19937_64 engine(static_cast<std::uint64_t>(seed) + 77);
    const double fault = 0.2 * std::uniform_real_distribution<double>()(engine);
    const auto strikes = [&] { return std::uniform_real_distribution<double>()(engine) < fault; };
    Mirror sut;
    std::vector<MapDelta> on_the_way;
    const bool asks = seed % 4 != 0;
    int refused = 0;
    const auto deliver = [&](const MapDelta& message) {
      const Mirror::Verdict verdict = sut.apply(message);
      ASSERT_NE(verdict, Mirror::Verdict::kDiffers);
      ASSERT_NE(verdict, Mirror::Verdict::kMalformed);
      refused += verdict == Mirror::Verdict::kOlderMap ? 1 : 0;
    };
    for (int update = 0; update < 40; ++update) {
      if (engine() % 25 == 0) {
        daemon.restart();
      }
      daemon.scan();
      daemon.tell([&](const MapDelta& message, DeltaKind) {
        for (int copies = strikes() ? 0 : strikes() ? 2 : 1; copies > 0; --copies) {
          strikes() ? on_the_way.push_back(message) : deliver(message);
        }
      });
      while (!on_the_way.empty() && engine() % 3 == 0) {  // late by any number of updates, in any order
        const std::size_t i = engine() % on_the_way.size();
        deliver(on_the_way[i]);
        on_the_way.erase(on_the_way.begin() + static_cast<std::ptrdiff_t>(i));
      }
      if (asks && sut.known() && !sut.complete() && !strikes()) {
        daemon.source.request(sut.request());
      }
      expect_truth(sut, daemon);
    }
    for (const MapDelta& message : on_the_way) {
      deliver(message);
    }
    // The network is good again: with a request, or by listening alone.
    int updates = 0;
    for (; updates < 30 && (updates == 0 || !sut.complete()); ++updates) {
      if (asks && sut.known()) {
        daemon.source.request(sut.request());
      }
      daemon.tell([&](const MapDelta& message, DeltaKind) { deliver(message); });
    }

    ASSERT_TRUE(sut.complete()) << "seed " << seed;
    ASSERT_LE(updates, asks ? 2 : 30);
    ASSERT_EQ(sut.map_id(), daemon.map_id);
    ASSERT_EQ(sut.newest(), daemon.grid.changes().newest());
    expect_truth(sut, daemon);
  }
}

TEST(Mirror, NeedsNoRequestWhereNothingIsLost) {
  Daemon daemon(1, DeltaConfig{.key_messages = 0, .repair_messages = 0});
  Mirror sut;
  for (int i = 0; i < 20; ++i) {
    daemon.scan();
    daemon.tell([&](const MapDelta& message, DeltaKind) { sut.apply(message); });
    ASSERT_TRUE(sut.complete());
    expect_truth(sut, daemon);
  }
}

TEST(Mirror, FindsOutThatItsCopyIsWrong) {
  Daemon daemon(2, DeltaConfig{.key_messages = 0, .repair_messages = 24});
  Mirror sut;
  daemon.scan();
  daemon.tell([&](MapDelta message, DeltaKind) {
    message.digest += 1;  // as if a block had been changed on its way
    sut.apply(message);
  });
  EXPECT_FALSE(sut.complete());
  EXPECT_EQ(sut.missing().size(), 1U);

  daemon.source.request(sut.request());
  daemon.tell([&](const MapDelta& message, DeltaKind) { sut.apply(message); });

  EXPECT_TRUE(sut.complete());
  expect_truth(sut, daemon);
}

TEST(Mirror, DropsAnOlderMapUntilToldToForget) {
  Daemon daemon(3);
  Mirror sut;
  std::vector<MapDelta> old;
  daemon.scan();
  daemon.tell([&](const MapDelta& message, DeltaKind) { old.push_back(message); });
  daemon.restart();
  daemon.scan();
  daemon.tell([&](const MapDelta& message, DeltaKind) { sut.apply(message); });

  EXPECT_EQ(sut.apply(old.front()), Mirror::Verdict::kOlderMap);
  EXPECT_EQ(sut.map_id(), 2);
  sut.forget();
  EXPECT_FALSE(sut.known());
  EXPECT_EQ(sut.apply(old.front()), Mirror::Verdict::kNewMap);
  EXPECT_EQ(sut.map_id(), 1);
}

TEST(DeltaSource, TellsWhatManyAskForOnceAndAtABoundedRate) {
  Daemon daemon(4, DeltaConfig{.key_messages = 1, .repair_messages = 2});
  for (int i = 0; i < 5; ++i) {
    daemon.scan();
    daemon.tell([](const MapDelta&, DeltaKind) {});
  }
  MapRequest request;
  request.map_id = daemon.map_id;
  request.ranges.push_back({0, std::uint64_t{1} << 60});  // more than there is
  MapRequest nonsense;
  nonsense.map_id = daemon.map_id;
  nonsense.ranges.push_back({50, 20});
  for (int i = 0; i < 1000; ++i) {
    daemon.source.request(request);
    daemon.source.request(nonsense);
  }

  std::vector<int> repairs;
  while (daemon.source.has_repairs()) {
    repairs.push_back(0);
    int keys = 0;
    daemon.tell([&](const MapDelta&, DeltaKind kind) {
      repairs.back() += kind == DeltaKind::kRepair ? 1 : 0;
      keys += kind == DeltaKind::kKey ? 1 : 0;
    });
    ASSERT_LE(keys, 1);
    ASSERT_LE(repairs.back(), 2);
    ASSERT_LT(repairs.size(), 30U);
  }
  EXPECT_GE(repairs.size(), 2U);
}

TEST(DeltaSource, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  Daemon daemon(5);
  daemon.scan();
  MapRequest request;
  request.map_id = daemon.map_id;
  request.ranges.push_back({0, 1000});
  DeltaKind kind{};

  const std::size_t allocations = support::count_allocations([&] {
    daemon.source.request(request);
    daemon.source.begin(Stamp{});
    while (daemon.source.next(daemon.message, kind)) {
    }
  });

  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace slamd::occupancy
