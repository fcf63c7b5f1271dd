#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/base/units.hpp"
#include "tools/simulate/mid360_lidar.hpp"
#include "tools/simulate/risley.hpp"
#include "tools/simulate/scenery.hpp"

namespace slamd::simulate {
namespace {

constexpr double kFirings_hz = 240'000.0;

Eigen::Vector3d shot(const Risley& sut, int i) { return sut.direction(i / kFirings_hz, i % 6); }

double azimuth_deg(const Eigen::Vector3d& d) { return std::atan2(d.y(), d.x()) / kDegree; }
double elevation_deg(const Eigen::Vector3d& d) { return std::asin(d.z()) / kDegree; }

// Source of all figures: livox-scan-pattern description, section 2 and golden vectors.

TEST(AviaPattern, LooksWhereTheGoldenDirectionsDo) {
  const Risley sut({0.0, 0.0, 0.0});
  struct Golden {
    int i;
    Eigen::Vector3d d;
  };
  const Golden golden[] = {{0, {0.815022, 0.577078, -0.052161}},    {1, {0.816278, 0.576782, -0.031829}},
                           {2, {0.816961, 0.576611, -0.009703}},    {3, {0.816935, 0.576596, 0.012437}},
                           {4, {0.816197, 0.576739, 0.034563}},     {5, {0.814892, 0.577007, 0.054894}},
                           {240, {0.882756, 0.465234, 0.065562}},   {245, {0.871887, 0.461610, 0.163493}},
                           {23994, {0.898599, 0.438594, 0.012474}}, {23999, {0.893422, 0.435840, 0.108817}}};

  for (const Golden& g : golden) {
    const double angle_deg = std::acos(std::min(1.0, shot(sut, g.i).dot(g.d.normalized()))) / kDegree;
    EXPECT_LT(angle_deg, 0.01) << "firing " << g.i;
  }
}

TEST(AviaPattern, HasThePublishedFieldOfView) {
  const Risley sut({0.4, 1.9, 3.3});
  double widest = 0.0;
  double highest = 0.0;
  double lowest = 0.0;

  for (int i = 0; i < 2'400'000; ++i) {
    const Eigen::Vector3d d = shot(sut, i);
    widest = std::max(widest, std::abs(azimuth_deg(d)));
    highest = std::max(highest, elevation_deg(d));
    lowest = std::min(lowest, elevation_deg(d));
  }

  EXPECT_NEAR(2.0 * widest, 70.4, 0.5);
  EXPECT_NEAR(highest - lowest, 77.2, 0.5);
}

TEST(AviaPattern, IsANarrowBandInRepetitiveMode) {
  const Risley sut({-0.7, 0.7, 2.1}, RisleyPattern::kRepetitive);
  double widest = 0.0;
  double highest = 0.0;
  double highest_ahead = 0.0;

  for (int i = 0; i < 240'000; ++i) {
    const Eigen::Vector3d d = shot(sut, i);
    widest = std::max(widest, std::abs(azimuth_deg(d)));
    highest = std::max(highest, std::abs(elevation_deg(d)));
    highest_ahead = std::abs(azimuth_deg(d)) < 5.0 ? std::max(highest_ahead, std::abs(elevation_deg(d))) : highest_ahead;
  }

  EXPECT_NEAR(2.0 * widest, 70.4, 0.5);
  EXPECT_NEAR(2.0 * highest_ahead, 4.5, 0.5);
  EXPECT_LT(highest, 4.5);  // the ends are higher
}

TEST(AviaPattern, ComesBackTenTimesASecondInRepetitiveModeOnly) {
  const Risley repetitive({-0.7, 0.7, 2.1}, RisleyPattern::kRepetitive);
  const Risley other({0.4, 1.9, 3.3});
  double widest_deg = 0.0;
  double other_deg = 0.0;

  for (int i = 0; i < 24'000; ++i) {
    widest_deg = std::max(widest_deg, (shot(repetitive, i) - shot(repetitive, i + 24'000)).norm() / kDegree);
    other_deg = std::max(other_deg, (shot(other, i) - shot(other, i + 24'000)).norm() / kDegree);
  }

  EXPECT_LT(widest_deg, 1e-6);
  EXPECT_GT(other_deg, 10.0);
}

TEST(AviaPattern, FillsTheViewAsFastAsTheRealOne) {
  const Risley sut({0.0, 0.0, 0.0});
  constexpr double kCell_deg = 0.2;
  const auto inside = [](double azimuth, double elevation) {
    return std::pow(azimuth / 35.2, 2) + std::pow(elevation / 38.6, 2) <= 1.0;
  };
  int cells = 0;
  for (int a = -180; a < 180; ++a) {
    for (int e = -200; e < 200; ++e) {
      cells += inside((a + 0.5) * kCell_deg, (e + 0.5) * kCell_deg) ? 1 : 0;
    }
  }
  std::set<std::pair<int, int>> seen;
  const auto fill_until = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      const Eigen::Vector3d d = shot(sut, i);
      const std::pair cell{static_cast<int>(std::floor(azimuth_deg(d) / kCell_deg)),
                           static_cast<int>(std::floor(elevation_deg(d) / kCell_deg))};
      if (inside((cell.first + 0.5) * kCell_deg, (cell.second + 0.5) * kCell_deg)) {
        seen.insert(cell);
      }
    }
    return 100.0 * static_cast<double>(seen.size()) / cells;
  };

  EXPECT_NEAR(fill_until(0, 24'000), 19.0, 2.0);
  EXPECT_NEAR(fill_until(24'000, 240'000), 86.0, 2.0);
  EXPECT_GT(fill_until(240'000, 2'400'000), 99.9);
}

TEST(AviaPattern, LooksAheadMoreOftenThanAside) {
  const Risley sut({0.0, 0.0, 0.0});
  int within[4] = {};
  const double angles_deg[4] = {5.0, 10.0, 20.0, 30.0};

  for (int i = 0; i < 2'400'000; ++i) {
    const double off_deg = std::acos(shot(sut, i).x()) / kDegree;
    for (int k = 0; k < 4; ++k) {
      within[k] += off_deg < angles_deg[k] ? 1 : 0;
    }
  }

  const double expected_percent[4] = {10.4, 21.3, 43.7, 69.8};
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(within[k] / 24'000.0, expected_percent[k], 1.0) << angles_deg[k];
  }
}

TEST(Mid360Pattern, CoversThePublishedFieldOfView) {
  const auto scenery = make_scenery("indoor", 1, {});
  const Motion motion = scenery->tour(10.0, 1.0, 1.0, 0.45);
  const Mid360Lidar sut(scenery->world(), motion, {}, {}, 1);
  double lowest = 90.0;
  double highest = -90.0;
  std::set<int> sectors;

  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector3d d = sut.direction(i / 200e3, i % 4);
    lowest = std::min(lowest, elevation_deg(d));
    highest = std::max(highest, elevation_deg(d));
    sectors.insert(static_cast<int>(std::floor(azimuth_deg(d))));
  }

  EXPECT_NEAR(lowest, -7.0, 0.2);
  EXPECT_NEAR(highest, 52.0, 0.2);
  EXPECT_GE(sectors.size(), 359U);
}

}  // namespace
}  // namespace slamd::simulate
