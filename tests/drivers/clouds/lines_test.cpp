#include "drivers/clouds/lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace slamd::clouds {
namespace {

// Sixteen lines, highest first, each once around from the front, with jitter and a gap.
std::vector<sensor::Point> line_by_line(double direction) {
  std::mt19937 random(1);
  std::normal_distribution<double> jitter_deg(0.0, 0.1);
  std::vector<sensor::Point> points;
  for (int line = 15; line >= 0; --line) {
    for (int i = 0; i < 900; ++i) {
      if (line == 3 && i > 400) {
        break;  // nothing behind
      }
      const double azimuth = direction * (i * 0.4 + jitter_deg(random)) * M_PI / 180.0;
      const double elevation = (line * 2.0 - 15.0) * M_PI / 180.0;
      sensor::Point p;
      p.x_m = static_cast<float>(10.0 * std::cos(elevation) * std::cos(azimuth));
      p.y_m = static_cast<float>(10.0 * std::cos(elevation) * std::sin(azimuth));
      p.z_m = static_cast<float>(10.0 * std::sin(elevation));
      p.tag = static_cast<std::uint8_t>(line);  // what it should be
      points.push_back(p);
    }
  }
  return points;
}

TEST(Lines, FollowTheFiringOrderOfEitherDirection) {
  for (const double direction : {1.0, -1.0}) {
    std::vector<sensor::Point> sut = line_by_line(direction);

    ASSERT_TRUE(set_lines_by_firing_order(sut));

    const auto wrong = std::count_if(
        sut.begin(), sut.end(), [](const sensor::Point& p) { return p.line != p.tag; });
    EXPECT_LE(wrong, 15);  // a line's last point may lie beyond the front already
  }
}

TEST(Lines, AreNotGuessedFromAnUnorderedCloud) {
  std::vector<sensor::Point> sut = line_by_line(1.0);
  std::shuffle(sut.begin(), sut.end(), std::mt19937(2));

  EXPECT_FALSE(set_lines_by_firing_order(sut));
  EXPECT_FALSE(set_lines_by_firing_order({}));
  EXPECT_EQ(sut[0].line, 0);
}

TEST(Lines, ByElevationPutNeighboursSideBySide) {
  std::vector<sensor::Point> sut = line_by_line(1.0);
  std::shuffle(sut.begin(), sut.end(), std::mt19937(2));

  set_lines_by_elevation(sut);

  for (std::size_t i = 1; i < sut.size(); ++i) {
    ASSERT_GE(sut[i].line, sut[i - 1].line);
    if (sut[i].line == sut[i - 1].line) {
      ASSERT_EQ(sut[i].tag, sut[i - 1].tag);
      ASSERT_GE(std::atan2(sut[i].y_m, sut[i].x_m), std::atan2(sut[i - 1].y_m, sut[i - 1].x_m));
    }
  }
  EXPECT_EQ(sut.back().line, 63);
}

}  // namespace
}  // namespace slamd::clouds
