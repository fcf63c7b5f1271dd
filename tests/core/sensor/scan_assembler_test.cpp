#include "core/sensor/scan_assembler.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace slamd::sensor {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr Duration kFiring{55296};

// A VLP-16 on a turntable: 24 sequences a packet, 12 with dual returns; a return of lasers 0 and 7
// each.
struct Spinner {
  double rate_hz = 10.0;
  double azimuth_deg = 0.0;
  Stamp time{seconds{1000}};
  bool dual = false;

  PointBlock next() {
    PointBlock block;
    const int count = dual ? 12 : 24;
    block.stamp = time;
    block.duration = count * kFiring;
    for (int s = 0; s < count; ++s) {
      const double azimuth = azimuth_deg + 360.0 * rate_hz * to_seconds(s * kFiring);
      const auto azimuth_cdeg = static_cast<std::uint32_t>(azimuth * 100.0) % 36000;
      block.sequences.push_back({static_cast<std::uint16_t>(block.points.size()),
                                 static_cast<std::uint16_t>(azimuth_cdeg),
                                 static_cast<std::uint32_t>((s * kFiring).count())});
      for (const int laser : {0, 7}) {
        for (int echo = 0; echo < (dual ? 2 : 1); ++echo) {
          Point point;
          point.x_m = static_cast<float>(azimuth_cdeg);
          point.offset_ns = static_cast<std::uint32_t>((s * kFiring).count() + laser * 2304);
          point.echo = static_cast<std::uint8_t>(echo);
          block.points.push_back(point);
        }
      }
    }
    azimuth_deg = std::fmod(azimuth_deg + 360.0 * rate_hz * to_seconds(block.duration), 360.0);
    time += block.duration;
    return block;
  }
};

// A Livox: 96 points a packet, 400 µs.
PointBlock livox_block(Stamp time) {
  PointBlock block;
  block.stamp = time;
  block.duration = microseconds{400};
  for (int i = 0; i < 96; ++i) {
    Point point;
    point.offset_ns = static_cast<std::uint32_t>(i * 4166);
    block.points.push_back(point);
  }
  return block;
}

ScanAssemblerConfig small_config() {
  ScanAssemblerConfig config;
  config.max_points = 16384;
  return config;
}

ScanAssemblerConfig livox_config() {
  ScanAssemblerConfig config = small_config();
  config.rule = CutRule::kPeriod;
  config.max_points = 32768;
  return config;
}

// What each scan that comes out must satisfy, whatever went in; keeps copies without points.
struct Checker {
  std::vector<Scan> scans;
  std::uint64_t points = 0;

  void check(const Scan* scan) {
    if (scan == nullptr) {
      return;
    }
    EXPECT_EQ(scan->index, scans.size());
    EXPECT_LT(scan->begin, scan->end);
    for (const Point& point : scan->points) {
      ASSERT_LT(scan->begin + nanoseconds{point.offset_ns}, scan->end);
    }
    if (!scans.empty()) {
      EXPECT_GE(scan->begin, scans.back().end);
    }
    points += scan->points.size();
    Scan copy;
    copy.index = scan->index;
    copy.begin = scan->begin;
    copy.end = scan->end;
    copy.complete = scan->complete;
    copy.points_dropped = scan->points_dropped;
    copy.points = BoundedVector<Point>(1);
    copy.points.push_back(scan->points.size() > 0 ? scan->points[0] : Point{});
    scans.push_back(copy);
  }
};

void expect_all_points_accounted_for(const ScanAssemblerCounts& counts,
                                     std::uint64_t fed,
                                     std::uint64_t out) {
  EXPECT_EQ(counts.points_in + counts.points_refused, fed);
  EXPECT_EQ(counts.points_out, out);
  EXPECT_EQ(counts.points_in,
            counts.points_out + counts.points_over_capacity + counts.points_unplaced +
                counts.points_reset);
}

class ScanAssemblerRates : public testing::TestWithParam<std::tuple<double, double, bool>> {};

TEST_P(ScanAssemblerRates, CutsRevolutionsAtTheCutAngle) {
  const auto [rate_hz, cut_deg, dual] = GetParam();
  ScanAssemblerConfig config = small_config();
  config.cut_azimuth_deg = cut_deg;
  ScanAssembler sut(config);
  Spinner spinner{.rate_hz = rate_hz, .azimuth_deg = 17.0, .dual = dual};
  Checker checker;
  std::uint64_t fed = 0;

  while (checker.scans.size() < 6) {
    const PointBlock block = spinner.next();
    fed += block.points.size();
    checker.check(sut.add(block));
  }
  checker.check(sut.flush());

  EXPECT_FALSE(checker.scans.front().complete);
  EXPECT_FALSE(checker.scans.back().complete);
  for (std::size_t i = 1; i + 1 < checker.scans.size(); ++i) {
    const Scan& scan = checker.scans[i];
    EXPECT_TRUE(scan.complete);
    EXPECT_EQ(scan.begin, checker.scans[i - 1].end);
    EXPECT_NEAR(to_seconds(scan.end - scan.begin), 1.0 / rate_hz, 60e-6);
    const double past_cut_deg = std::fmod(scan.points[0].x_m / 100.0 - cut_deg + 720.0, 360.0);
    EXPECT_LT(past_cut_deg, 360.0 * rate_hz * to_seconds(kFiring) + 0.02);
  }
  expect_all_points_accounted_for(sut.counts(), fed, checker.points);
}

INSTANTIATE_TEST_SUITE_P(SpinRates,
                         ScanAssemblerRates,
                         testing::Combine(testing::Values(5.0, 10.0, 20.0),
                                          testing::Values(180.0, 0.0, 359.99, -90.0, 17.3),
                                          testing::Bool()));

TEST(ScanAssembler, ScanThatBeginsAtTheCutIsComplete) {
  ScanAssembler sut(small_config());
  Spinner spinner{.azimuth_deg = 180.0};

  const Scan* first = nullptr;
  while (first == nullptr) {
    first = sut.add(spinner.next());
  }

  EXPECT_TRUE(first->complete);
  EXPECT_EQ(first->begin, Stamp{seconds{1000}});
}

TEST(ScanAssembler, CompletedScanStaysUntilTheNextCompletes) {
  ScanAssembler sut(small_config());
  Spinner spinner;
  const Scan* first = nullptr;
  while (first == nullptr) {
    first = sut.add(spinner.next());
  }
  const Stamp begin = first->begin;
  const std::size_t points = first->points.size();

  for (int i = 0; i < 60; ++i) {
    ASSERT_EQ(sut.add(spinner.next()), nullptr);
  }

  EXPECT_EQ(first->begin, begin);
  EXPECT_EQ(first->points.size(), points);
}

// With a field of view of half a turn, one packet a turn holds the end of one sweep and the beginning of the next.
TEST(ScanAssembler, CutsInsideABlockThatLeavesASectorOut) {
  ScanAssembler sut(small_config());
  Checker checker;
  Spinner spinner{.azimuth_deg = 270.0};
  for (int i = 0; i < 37; ++i) {
    checker.check(sut.add(spinner.next()));
  }
  PointBlock block = spinner.next();
  const Duration hole = milliseconds{50} - milliseconds{50} % kFiring;
  for (std::size_t s = 12; s < 24; ++s) {
    block.sequences[s].azimuth_cdeg = static_cast<std::uint16_t>((block.sequences[s].azimuth_cdeg + 18000) % 36000);
    block.sequences[s].offset_ns += static_cast<std::uint32_t>(hole.count());
  }
  for (std::size_t i = block.sequences[12].first_point; i < block.points.size(); ++i) {
    block.points[i].offset_ns += static_cast<std::uint32_t>(hole.count());
  }
  block.duration += hole;

  const Scan* scan = sut.add(block);

  ASSERT_NE(scan, nullptr);
  checker.check(scan);
  EXPECT_EQ(scan->end, block.stamp + Duration{block.sequences[12].offset_ns});
  EXPECT_EQ(scan->points.size(), 37U * 48 + 24);
  spinner.azimuth_deg = std::fmod(spinner.azimuth_deg + 180.0, 360.0);
  spinner.time += hole;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(sut.add(spinner.next()), nullptr);
  }
  EXPECT_EQ(sut.counts().blocks_missing, 0U);
  EXPECT_EQ(sut.counts().blocks_accepted, 48U);
}

TEST(ScanAssembler, CutsOnceWhenTheAzimuthTremblesAtTheCut) {
  ScanAssembler sut(small_config());
  Checker checker;
  PointBlock block = Spinner{}.next();
  std::uint16_t azimuth = 17000;

  for (int i = 0; i < 120; ++i) {
    for (std::size_t s = 0; s < block.sequences.size(); ++s) {
      block.sequences[s].azimuth_cdeg = static_cast<std::uint16_t>(azimuth + (s % 2 == 0 ? 3 : 0));
      azimuth = static_cast<std::uint16_t>(azimuth + (i < 40 ? 1 : 0));
    }
    checker.check(sut.add(block));
    block.stamp += block.duration;
  }

  EXPECT_LE(checker.scans.size(), 1U);
}

TEST(ScanAssembler, RefusesDuplicateLateAndBackwardBlocksByReason) {
  ScanAssembler sut(small_config());
  Spinner spinner;
  const PointBlock a = spinner.next();
  const PointBlock b = spinner.next();
  PointBlock long_ago = a;
  long_ago.stamp -= seconds{5};

  sut.add(a);
  sut.add(b);
  EXPECT_EQ(sut.add(b), nullptr);
  EXPECT_EQ(sut.add(a), nullptr);
  EXPECT_EQ(sut.add(long_ago), nullptr);

  EXPECT_EQ(sut.counts().refused_for(BlockRefusal::kDuplicate), 1U);
  EXPECT_EQ(sut.counts().refused_for(BlockRefusal::kLate), 1U);
  EXPECT_EQ(sut.counts().refused_for(BlockRefusal::kBackward), 1U);
  EXPECT_EQ(sut.counts().blocks_accepted, 2U);
  EXPECT_EQ(sut.counts().blocks_missing, 0U);
}

TEST(ScanAssembler, RefusesMalformedBlocks) {
  const PointBlock good = Spinner{}.next();
  std::vector<PointBlock> bad(9, good);
  bad[0].sequences.clear();
  bad[1].sequences[3].azimuth_cdeg = 36000;
  bad[2].sequences[4].first_point = 2;
  bad[3].sequences[23].first_point = 700;
  bad[4].duration = Duration::zero();
  bad[5].points.back().offset_ns = 4'000'000'000;
  bad[6].duration = seconds{1};
  bad[7].sequences[9].offset_ns = bad[7].sequences[8].offset_ns;
  bad[8].sequences[23].offset_ns = 24 * 55'296;

  ScanAssembler sut(small_config());
  for (const PointBlock& block : bad) {
    sut.add(block);
  }

  EXPECT_EQ(sut.counts().refused_for(BlockRefusal::kMalformed), bad.size());
  EXPECT_EQ(sut.counts().blocks_accepted, 0U);
  EXPECT_EQ(sut.flush(), nullptr);
}

TEST(ScanAssembler, ScanWithAMissingPacketIsIncompleteAndOnlyThatOne) {
  ScanAssembler sut(small_config());
  Spinner spinner{.azimuth_deg = 180.0};
  Checker checker;

  for (int i = 0; i < 320; ++i) {
    const PointBlock block = spinner.next();
    if (i != 110) {
      checker.check(sut.add(block));
    }
  }

  ASSERT_EQ(checker.scans.size(), 4U);
  EXPECT_TRUE(checker.scans[0].complete);
  EXPECT_FALSE(checker.scans[1].complete);
  EXPECT_TRUE(checker.scans[2].complete);
  EXPECT_TRUE(checker.scans[3].complete);
  EXPECT_EQ(sut.counts().blocks_missing, 1U);
}

TEST(ScanAssembler, PacketsMissingAroundTheCutMakeBothScansIncomplete) {
  ScanAssembler sut(small_config());
  Spinner spinner{.azimuth_deg = 180.0};
  Checker checker;
  Stamp data_end{};

  for (int i = 0; i < 320; ++i) {
    const PointBlock block = spinner.next();
    if (i >= 72 && i < 80) {
      continue;
    }
    if (i == 71) {
      data_end = block.stamp + block.duration;
    }
    checker.check(sut.add(block));
  }

  ASSERT_EQ(checker.scans.size(), 4U);
  EXPECT_FALSE(checker.scans[0].complete);
  EXPECT_EQ(checker.scans[0].end, data_end);
  EXPECT_FALSE(checker.scans[1].complete);
  EXPECT_EQ(checker.scans[1].begin, data_end + 8 * 24 * kFiring);
  EXPECT_TRUE(checker.scans[2].complete);
  EXPECT_EQ(sut.counts().blocks_missing, 8U);
}

TEST(ScanAssembler, GapLongerThanARevolutionClosesTheScan) {
  ScanAssembler sut(small_config());
  Spinner spinner{.azimuth_deg = 180.0};
  Checker checker;
  for (int i = 0; i < 30; ++i) {
    checker.check(sut.add(spinner.next()));
  }
  const Stamp data_end = spinner.time;
  spinner.time += milliseconds{250};

  checker.check(sut.add(spinner.next()));
  checker.check(sut.add(spinner.next()));  // so it was no wild stamp

  ASSERT_EQ(checker.scans.size(), 1U);
  EXPECT_FALSE(checker.scans[0].complete);
  EXPECT_EQ(checker.scans[0].end, data_end);
}

TEST(ScanAssembler, FragmentBetweenAGapAndACutInOneBlockIsCounted) {
  ScanAssembler sut(small_config());
  Spinner spinner{.azimuth_deg = 90.0};
  Checker checker;
  std::uint64_t fed = 0;
  for (int i = 0; i < 10; ++i) {
    const PointBlock block = spinner.next();
    fed += block.points.size();
    checker.check(sut.add(block));
  }
  spinner.time += seconds{3};
  spinner.azimuth_deg = 179.0;

  for (int i = 0; i < 2; ++i) {
    const PointBlock block = spinner.next();
    fed += block.points.size();
    checker.check(sut.add(block));
  }
  checker.check(sut.flush());

  EXPECT_EQ(checker.scans.size(), 2U);
  EXPECT_EQ(sut.counts().points_unplaced, 12U);  // 6 sequences of 0.2° before the cut
  expect_all_points_accounted_for(sut.counts(), fed, checker.points);
}

TEST(ScanAssembler, SensorThatDoesNotTurnMakesShortIncompleteScans) {
  ScanAssembler sut(small_config());
  Spinner spinner{.rate_hz = 0.0, .azimuth_deg = 42.0};
  Checker checker;

  for (int i = 0; i < 2000; ++i) {
    checker.check(sut.add(spinner.next()));
  }

  ASSERT_GE(checker.scans.size(), 4U);
  for (const Scan& scan : checker.scans) {
    EXPECT_FALSE(scan.complete);
    EXPECT_LE(scan.end - scan.begin, ScanAssembler::kLongestScan);
  }
}

TEST(ScanAssembler, CountsPointsBeyondTheCapacity) {
  ScanAssemblerConfig config = small_config();
  config.max_points = 1000;
  ScanAssembler sut(config);
  Spinner spinner{.azimuth_deg = 180.0};
  Checker checker;
  std::uint64_t fed = 0;

  while (checker.scans.size() < 3) {
    const PointBlock block = spinner.next();
    fed += block.points.size();
    checker.check(sut.add(block));
  }
  checker.check(sut.flush());

  EXPECT_GT(checker.scans[0].points_dropped, 2000U);
  expect_all_points_accounted_for(sut.counts(), fed, checker.points);
}

TEST(ScanAssembler, SurvivesStampsThatOverlapWhileAClockIsCorrected) {
  ScanAssembler sut(small_config());
  Spinner spinner{.azimuth_deg = 180.0};
  std::uint64_t scans = 0;

  for (int i = 0; i < 400; ++i) {
    PointBlock block = spinner.next();
    block.stamp -= Duration{(block.stamp - Stamp{seconds{1000}}).count() / 50};  // 2 % too fast
    if (const Scan* scan = sut.add(block)) {
      ++scans;
      EXPECT_TRUE(scan->complete);
      for (const Point& point : scan->points) {
        ASSERT_LT(scan->begin + nanoseconds{point.offset_ns}, scan->end);
      }
    }
  }

  EXPECT_EQ(scans, 5U);
  EXPECT_EQ(sut.counts().blocks_accepted, 400U);
}

TEST(ScanAssembler, CutsLivoxBlocksEveryPeriodOfDeviceTime) {
  ScanAssembler sut(livox_config());
  Checker checker;
  std::uint64_t fed = 0;

  // 100 ms are 250 packets of 400 µs; begin off the packet grid, so that cuts fall into packets.
  for (int i = 0; i < 1100; ++i) {
    const PointBlock block = livox_block(Stamp{seconds{5}} + i * nanoseconds{400'137});
    fed += block.points.size();
    checker.check(sut.add(block));
  }
  checker.check(sut.flush());

  ASSERT_EQ(checker.scans.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(checker.scans[i].begin, Stamp{seconds{5}} + static_cast<int>(i) * milliseconds{100});
    EXPECT_EQ(checker.scans[i].end, checker.scans[i].begin + milliseconds{100});
    EXPECT_EQ(checker.scans[i].complete, i < 4);
  }
  expect_all_points_accounted_for(sut.counts(), fed, checker.points);
}

TEST(ScanAssembler, LivoxGapKeepsTheGridUpToAPeriodAndBeginsAnewBeyond) {
  ScanAssembler sut(livox_config());
  Checker checker;
  for (int i = 0; i < 1000; ++i) {
    if ((i >= 200 && i < 300) || (i >= 600 && i < 901)) {
      continue;  // 40 ms across a cut; 120 ms
    }
    checker.check(sut.add(livox_block(Stamp{seconds{5}} + i * microseconds{400})));
  }
  checker.check(sut.flush());

  ASSERT_EQ(checker.scans.size(), 4U);
  EXPECT_FALSE(checker.scans[0].complete);
  EXPECT_FALSE(checker.scans[1].complete);
  EXPECT_EQ(checker.scans[1].begin, Stamp{seconds{5}} + milliseconds{100});
  EXPECT_FALSE(checker.scans[2].complete);
  EXPECT_EQ(checker.scans[3].begin, Stamp{seconds{5}} + 901 * microseconds{400});
  EXPECT_EQ(sut.counts().blocks_missing, 401U);
}

TEST(ScanAssembler, ResetLetsTheClockBeginAnew) {
  ScanAssembler sut(small_config());
  Spinner spinner;
  Checker checker;
  std::uint64_t fed = 0;
  for (int i = 0; i < 20; ++i) {
    const PointBlock block = spinner.next();
    fed += block.points.size();
    checker.check(sut.add(block));
  }

  sut.reset();
  spinner.time = Stamp{seconds{10}};
  const PointBlock block = spinner.next();
  fed += block.points.size();
  checker.check(sut.add(block));
  checker.check(sut.flush());

  EXPECT_EQ(sut.counts().blocks_accepted, 21U);
  EXPECT_EQ(checker.scans.size(), 1U);
  EXPECT_GT(sut.counts().points_reset, 0U);
  expect_all_points_accounted_for(sut.counts(), fed, checker.points);
}

TEST(ScanAssembler, RefusesOneWildStampAndGoesOn) {
  for (const bool livox : {false, true}) {
    for (const Duration wild : {Duration{seconds{3600}}, Duration{milliseconds{300}}, Duration{-seconds{3600}}}) {
      ScanAssembler sut(livox ? livox_config() : small_config());
      Spinner spinner;
      Checker checker;
      std::uint64_t fed = 0;
      for (int i = 0; i < 1000; ++i) {
        PointBlock block = livox ? livox_block(spinner.time) : spinner.next();
        spinner.time += livox ? block.duration : Duration::zero();
        block.stamp += i == 500 ? wild : Duration{};
        fed += block.points.size();
        checker.check(sut.add(block));
      }
      checker.check(sut.flush());

      EXPECT_EQ(sut.counts().refused_for(wild > Duration{} ? BlockRefusal::kFarAhead : BlockRefusal::kBackward), 1U);
      EXPECT_EQ(sut.counts().blocks_accepted, 999U);
      EXPECT_EQ(sut.counts().blocks_missing, 1U);
      EXPECT_EQ(checker.scans.size(), livox ? 4U : 14U);
      expect_all_points_accounted_for(sut.counts(), fed, checker.points);
    }
  }
}

TEST(ScanAssembler, GivesUpAWildFirstStampWithinAThirdOfASecond) {
  ScanAssembler sut(small_config());
  Spinner spinner;
  Checker checker;
  std::uint64_t fed = 0;
  for (int i = 0; i < 500; ++i) {
    PointBlock block = spinner.next();
    block.stamp += i == 0 ? seconds{3600} : seconds{0};
    fed += block.points.size();
    checker.check(sut.add(block));
  }
  checker.check(sut.flush());

  EXPECT_EQ(sut.counts().restarts, 1U);
  EXPECT_LT(sut.counts().refused_for(BlockRefusal::kBackward), 230U);
  EXPECT_GE(checker.scans.size(), 4U);
  expect_all_points_accounted_for(sut.counts(), fed, checker.points);
}

TEST(ScanAssembler, LosesNoBlockOfAGap) {
  ScanAssembler sut(small_config());
  Spinner spinner;
  for (int i = 0; i < 200; ++i) {
    spinner.time += i == 100 ? seconds{2} : seconds{0};
    sut.add(spinner.next());
  }

  EXPECT_EQ(sut.counts().blocks_accepted, 200U);
}

// Whatever is lost, repeated, swapped or delayed: no point vanishes uncounted and every scan is
// sound.
TEST(ScanAssembler, AccountsForEveryPointUnderRandomFaults) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const bool livox = seed % 4 == 3;
    ScanAssemblerConfig config = livox ? livox_config() : small_config();
    config.cut_azimuth_deg = static_cast<double>(random() % 360);
    ScanAssembler sut(config);
    Spinner spinner{.rate_hz = 5.0 * static_cast<double>(1U << (seed % 3)), .dual = seed % 2 == 1};
    Checker checker;
    PointBlock held;
    bool holding = false;
    std::uint64_t fed = 0;
    const auto feed = [&](const PointBlock& block) {
      fed += block.points.size();
      checker.check(sut.add(block));
    };

    for (int i = 0; i < 1500; ++i) {
      const PointBlock block = livox ? livox_block(spinner.time) : spinner.next();
      spinner.time += livox ? block.duration : Duration::zero();
      const std::uint32_t dice = random() % 100;
      if (dice < 3) {
        continue;
      }
      if (dice == 3) {
        spinner.time += milliseconds{random() % 400};
      }
      if (dice == 6) {
        PointBlock wild = block;
        wild.stamp += milliseconds{(random() % 2 == 0 ? 1 : -1) * static_cast<int>(300 + random() % 2000)};
        feed(wild);
        continue;
      }
      if (dice == 4 && !holding) {
        held = block;
        holding = true;
        continue;
      }
      feed(block);
      if (dice == 5) {
        feed(block);
      }
      if (holding && dice < 30) {
        feed(held);
        holding = false;
      }
    }
    checker.check(sut.flush());

    expect_all_points_accounted_for(sut.counts(), fed, checker.points);
    EXPECT_EQ(sut.counts().scans, checker.scans.size());
    EXPECT_GT(checker.scans.size(), 3U);
  }
}

TEST(ScanAssembler, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  ScanAssembler sut(small_config());
  Spinner spinner;
  int scans = 0;

  const std::size_t allocations = support::count_allocations([&] {
    for (int i = 0; i < 400; ++i) {
      const PointBlock block = spinner.next();
      scans += sut.add(block) != nullptr ? 1 : 0;
      sut.add(block);
    }
    scans += sut.flush() != nullptr ? 1 : 0;
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_GE(scans, 6);
}

TEST(ScanAssembler, NamesEveryReason) {
  EXPECT_EQ(to_string(BlockRefusal::kDuplicate), "duplicate");
  EXPECT_EQ(to_string(BlockRefusal::kLate), "late");
  EXPECT_EQ(to_string(BlockRefusal::kBackward), "backward");
  EXPECT_EQ(to_string(BlockRefusal::kMalformed), "malformed");
  EXPECT_EQ(to_string(BlockRefusal::kFarAhead), "far_ahead");
}

}  // namespace
}  // namespace slamd::sensor
