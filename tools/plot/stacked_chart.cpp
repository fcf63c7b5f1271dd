#include "tools/plot/stacked_chart.hpp"

#include <algorithm>
#include <numeric>

#include "tools/plot/axes.hpp"
#include "tools/plot/legend.hpp"
#include "tools/plot/line_chart.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/svg.hpp"

namespace slamd::plot {

namespace {

constexpr std::size_t kMaxBins = 160;
constexpr double kHeight = 220.0;

double mean(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last = values.begin() + static_cast<std::ptrdiff_t>(end);
  return std::accumulate(first, last, 0.0) / static_cast<double>(end - begin);
}

std::string rectangle(double left, double right, double top, double bottom) {
  return "M" + coordinate(left) + " " + coordinate(top) + "H" + coordinate(right) + "V" +
         coordinate(bottom) + "H" + coordinate(left) + "z";
}

}  // namespace

std::string svg_of(const StackedChart& chart) {
  const std::size_t count = chart.x.size();
  const std::size_t bins = std::min(count, kMaxBins);
  const auto begin_of = [&](std::size_t bin) {
    return bin * count / bins;
  };
  std::vector<std::vector<double>> tops(chart.layers.size() + 1, std::vector<double>(bins, 0.0));
  Range x;
  Range y;
  y.include(0.0);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    for (std::size_t k = 0; k < chart.layers.size(); ++k) {
      tops[k + 1][bin] = tops[k][bin] + mean(chart.layers[k].y, begin_of(bin), begin_of(bin + 1));
    }
    y.include(tops.back()[bin]);
    x.include(chart.x[begin_of(bin)]);
  }
  if (count > 0) {
    x.include(chart.x.back());
  }
  x.widen(0.0);
  y.widen(0.06);
  y.low = 0.0;

  Legend legend;
  for (std::size_t k = 0; k < chart.layers.size(); ++k) {
    legend.push_back({chart.layers[k].name, kSeriesColours[k % kSeriesColours.size()], Mark::kBox});
  }
  const PlacedLegend placed = place(legend, kAxesLeft, kAxesLeft + kAxesWidth);
  const Axes axes({kAxesLeft, placed.height + 26.0, kAxesWidth, kHeight}, x, y);
  std::string body = placed.svg + axes.svg(chart.x_label, chart.y_label);
  for (std::size_t k = 0; k < chart.layers.size(); ++k) {
    std::string path;
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const double left = axes.px(chart.x[begin_of(bin)]);
      const double right = bin + 1 < bins ? axes.px(chart.x[begin_of(bin + 1)]) : kAxesLeft + kAxesWidth;
      path += rectangle(
          left, std::max(right, left + 0.5), axes.py(tops[k + 1][bin]), axes.py(tops[k][bin]));
    }
    body += "<path fill=\"" + std::string(kSeriesColours[k % kSeriesColours.size()]) + "\" d=\"" +
            path + "\"/>\n";
  }
  return document(kDrawingWidth, placed.height + 26.0 + kHeight + 46.0, chart.alt, body);
}

}  // namespace slamd::plot
