#include "daemon/stages/waiting_scan.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace slamd::stages {
namespace {

sensor::Scan scan_of(std::uint64_t index, std::size_t points) {
  sensor::Scan scan(16);
  scan.index = index;
  scan.end = Stamp{} + std::chrono::milliseconds(100 * index);
  scan.complete = false;
  scan.points.resize(points);
  return scan;
}

const auto ready = [](const sensor::Scan&) { return true; };
const auto not_ready = [](const sensor::Scan&) { return false; };

TEST(WaitingScan, PassesAReadyScanOnWithoutCopyingIt) {
  const sensor::Scan scan = scan_of(1, 3);
  const sensor::Scan* seen = nullptr;
  WaitingScan sut(16);

  sut.add(scan, Stamp{}, ready, [&](const sensor::Scan& processed, Stamp) { seen = &processed; });

  EXPECT_EQ(seen, &scan);
  EXPECT_FALSE(sut.is_waiting());
}

TEST(WaitingScan, KeepsAllOfAScanUntilItIsReady) {
  const Stamp received = Stamp{} + std::chrono::seconds(7);
  int processed = 0;
  WaitingScan sut(16);
  const auto check = [&](const sensor::Scan& scan, Stamp when) {
    ++processed;
    EXPECT_EQ(scan.index, 1U);
    EXPECT_EQ(scan.end, Stamp{} + std::chrono::milliseconds(100));
    EXPECT_FALSE(scan.complete);
    EXPECT_EQ(scan.points.size(), 3U);
    EXPECT_EQ(when, received);
  };

  {
    const sensor::Scan gone = scan_of(1, 3);
    sut.add(gone, received, not_ready, check);
  }
  sut.release(not_ready, check);
  EXPECT_EQ(processed, 0);
  sut.release(ready, check);
  sut.release(ready, check);

  EXPECT_EQ(processed, 1);
}

TEST(WaitingScan, LetsTheOlderOneGoFirst) {
  std::vector<std::uint64_t> order;
  WaitingScan sut(16);
  const auto note = [&](const sensor::Scan& scan, Stamp) { order.push_back(scan.index); };

  sut.add(scan_of(1, 0), Stamp{}, not_ready, note);
  sut.add(scan_of(2, 0), Stamp{}, ready, note);
  sut.add(scan_of(3, 0), Stamp{}, not_ready, note);
  sut.flush(note);

  EXPECT_EQ(order, (std::vector<std::uint64_t>{1, 2, 3}));
}

}  // namespace
}  // namespace slamd::stages
