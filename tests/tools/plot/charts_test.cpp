#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "tools/plot/line_chart.hpp"
#include "tools/plot/stacked_chart.hpp"
#include "tools/plot/timeline.hpp"

namespace slamd::plot {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++n;
  }
  return n;
}

Series line(std::string name, std::vector<double> x, std::vector<double> y) {
  Series series;
  series.name = std::move(name);
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

/// The drawing's path of the first series.
std::string path_in(const std::string& svg) {
  const std::size_t begin = svg.find(" d=\"M", svg.find("stroke-linejoin")) + 4;
  return svg.substr(begin, svg.find('"', begin) - begin);
}

TEST(LineChart, NamesSeriesAndAxes) {
  LineChart chart;
  chart.alt = "Error over time";
  chart.x_label = "time [s]";
  chart.y_label = "error [m]";
  chart.series = {line("psf", {0, 1, 2}, {0, 1, 0}), line("iekf & co", {0, 1, 2}, {1, 1, 1})};

  const std::string sut = svg_of(chart);

  EXPECT_TRUE(contains(sut, "aria-label=\"Error over time\""));
  EXPECT_TRUE(contains(sut, ">time [s]</text>"));
  EXPECT_TRUE(contains(sut, ">error [m]</text>"));
  EXPECT_TRUE(contains(sut, ">iekf &amp; co</text>"));
}

TEST(LineChart, LiftsThePenWhereAValueIsMissing) {
  LineChart chart;
  chart.series = {line("a", {0, 1, 2, 3, 4}, {0, 1, std::nan(""), 1, 0})};

  EXPECT_EQ(count(path_in(svg_of(chart)), "M"), 2U);
}

TEST(LineChart, ThinsALongLineButKeepsItsPeak) {
  LineChart chart;
  chart.from_zero = true;
  Series series = line("a", {}, {});
  for (int i = 0; i < 100'000; ++i) {
    series.x.push_back(i);
    series.y.push_back(i == 70'001 ? 1000.0 : 1.0);
  }
  chart.series = {series};

  const std::string path = path_in(svg_of(chart));

  EXPECT_LT(count(path, "L"), 3000U);
  // The peak is the highest corner of the drawing: 6 % of the range below the plot's top.
  EXPECT_TRUE(contains(path, " 58.45")) << path.substr(0, 200);
}

TEST(LineChart, DrawsAMetreAsLongInBothDirections) {
  LineChart chart;
  chart.equal_scale = true;
  chart.series = {line("square", {0, 10, 10, 0}, {0, 0, 10, 10})};

  double x[4];
  double y[4];
  const std::string path = path_in(svg_of(chart));
  ASSERT_EQ(std::sscanf(
                path.c_str(), "M%lf %lfL%lf %lfL%lf %lf", &x[0], &y[0], &x[1], &y[1], &x[2], &y[2]),
            6);

  EXPECT_NEAR(x[1] - x[0], y[1] - y[2], 0.05);
}

TEST(LineChart, PutsAScaleBarOnAPictureOnly) {
  LineChart chart;
  chart.equal_scale = true;
  chart.series = {line("a", {0, 100}, {0, 100})};
  LineChart on_picture = chart;
  on_picture.backdrop = Backdrop{{0.0, 100.0}, {0.0, 100.0}, "data:image/png;base64,"};

  const std::string sut = svg_of(chart);
  const std::string sut_on_picture = svg_of(on_picture);

  EXPECT_FALSE(contains(sut, " m</text>"));
  EXPECT_TRUE(contains(sut_on_picture, " m</text>"));
}

TEST(LineChart, DrawsABroadLineForOthersToLieOn) {
  LineChart chart;
  chart.series = {line("a", {0, 1}, {0, 1}), line("b", {0, 1}, {0, 1})};
  chart.series[0].broad = true;

  const std::string sut = svg_of(chart);

  EXPECT_EQ(count(sut, "stroke-width=\"5\""), 1U);
  EXPECT_EQ(count(sut, "stroke-width=\"1.8\""), 1U);
}

TEST(LineChart, NumbersALowDrawingAtTwoHeightsAtLeast) {
  LineChart chart;
  chart.equal_scale = true;
  chart.y_label = "z [m]";
  chart.series = {line("a", {0, 208}, {0, 0})};
  chart.backdrop = Backdrop{{0.0, 208.0}, {-7.0, 19.0}, "data:image/png;base64,"};
  chart.y_stretch = 2.0;

  const std::string sut = svg_of(chart);

  EXPECT_TRUE(contains(sut, ">0</text>"));
  EXPECT_TRUE(contains(sut, ">10</text>"));
}

TEST(LineChart, DrawsNothingFromNothing) {
  const std::string sut = svg_of(LineChart{});

  EXPECT_FALSE(contains(sut, "nan"));
  EXPECT_FALSE(contains(sut, "inf"));
}

TEST(StackedChart, PutsLayersOnEachOther) {
  StackedChart chart;
  chart.x = {0.0, 1.0, 2.0};
  chart.layers = {{"low", {1.0, 1.0, 1.0}}, {"high", {2.0, 2.0, 2.0}}};

  const std::string sut = svg_of(chart);

  // The second layer begins where the first one ends.
  const std::size_t first = sut.find("d=\"M58 ", sut.find("#0072b2\" d="));
  const std::size_t second = sut.find("d=\"M58 ", sut.find("#d55e00\" d="));
  double top_of_first = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  ASSERT_EQ(std::sscanf(sut.c_str() + first, "d=\"M58 %lf", &top_of_first), 1);
  ASSERT_EQ(std::sscanf(sut.c_str() + second, "d=\"M58 %lfH%lfV%lf", &top, &right, &bottom), 3);
  EXPECT_DOUBLE_EQ(bottom, top_of_first);
  EXPECT_LT(top, top_of_first);
}

TEST(StackedChart, BinsWhatIsFinerThanTheEyeSees) {
  StackedChart chart;
  chart.layers = {{"a", {}}};
  for (int i = 0; i < 50'000; ++i) {
    chart.x.push_back(i);
    chart.layers[0].y.push_back(1.0);
  }

  EXPECT_LT(svg_of(chart).size(), 20'000U);
}

TEST(StackedChart, DrawsNothingFromNothing) {
  EXPECT_FALSE(contains(svg_of(StackedChart{}), "nan"));
}

TEST(Timeline, ShowsEvenAMomentAndSaysWhy) {
  Timeline chart;
  chart.colours = {{"TRACKING", "#009e73"}, {"LOST", "#d55e00"}, {"STARTING", "#56b4e9"}};
  chart.rows = {
      {"psf", {{0, 1000, "TRACKING", "TRACKING"}, {500, 500, "LOST", "LOST: few inliers"}}}};

  const std::string sut = svg_of(chart);

  EXPECT_TRUE(contains(sut, "<title>LOST: few inliers</title>"));
  EXPECT_TRUE(contains(sut, "width=\"1.5\""));
  EXPECT_FALSE(contains(sut, "STARTING"));  // a legend of what is there
}

}  // namespace
}  // namespace slamd::plot
