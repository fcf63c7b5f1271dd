#include "tools/plot/line_chart.hpp"

#include <algorithm>
#include <cmath>

#include "tools/plot/legend.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/svg.hpp"

namespace slamd::plot {

namespace {

constexpr double kBottom = 46.0;
constexpr double kPlotHeight = 220.0;
constexpr double kMaxPlotHeight = 520.0;

std::string colour_of(const LineChart& chart, std::size_t i) {
  return chart.series[i].colour.empty() ? kSeriesColours[i % kSeriesColours.size()]
                                        : chart.series[i].colour;
}

void find_ranges(const LineChart& chart, Range& x, Range& y) {
  if (chart.backdrop) {
    x = chart.backdrop->x;
    y = chart.backdrop->y;
    return;
  }
  for (const Series& series : chart.series) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (std::isfinite(series.y[i])) {
        x.include(series.x[i]);
        y.include(series.y[i]);
      }
    }
  }
  x.widen(chart.equal_scale ? 0.05 : 0.0);
  if (chart.from_zero) {
    y.include(0.0);
  }
  y.widen(0.06);
  if (chart.from_zero) {
    y.low = 0.0;
  }
}

/// Chooses the plot's height and, for equal scales, widens the range that has room to spare.
double fit_height(const LineChart& chart, double width, Range& x, Range& y) {
  if (!chart.equal_scale) {
    return kPlotHeight;
  }
  const double wanted = width * chart.y_stretch * y.size() / x.size();
  if (chart.backdrop) {
    return wanted;
  }
  const double height = std::clamp(wanted, 140.0, kMaxPlotHeight);
  if (wanted > height) {
    x.widen(0.5 * (wanted / height - 1.0));
  } else {
    y.widen(0.5 * (height / wanted - 1.0));
  }
  return height;
}

std::string points_of(const Series& series, const Axes& axes, const std::string& colour) {
  std::string body = "<g fill=\"" + colour + "\">\n";
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (std::isfinite(series.y[i])) {
      body += "<circle cx=\"" + coordinate(axes.px(series.x[i])) + "\" cy=\"" +
              coordinate(axes.py(series.y[i])) + "\" r=\"3\"/>\n";
    }
  }
  return body + "</g>\n";
}

/// The corners of a line. Points within half a unit of the last drawn one are left out: a peak is
/// farther than that.
std::string path_of(const Series& series, const Axes& axes) {
  std::string path;
  bool pen_down = false;
  double last_x = 0.0;
  double last_y = 0.0;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.y[i])) {
      pen_down = false;
      continue;
    }
    const double x = axes.px(series.x[i]);
    const double y = axes.py(series.y[i]);
    const bool is_last = i + 1 == series.x.size();
    if (pen_down && !is_last && std::hypot(x - last_x, y - last_y) < 0.5) {
      continue;
    }
    path += (pen_down ? "L" : "M") + coordinate(x) + " " + coordinate(y);
    pen_down = true;
    last_x = x;
    last_y = y;
  }
  return path;
}

std::string line_of(const Series& series, const Axes& axes, const std::string& colour) {
  return "<path fill=\"none\" stroke=\"" + colour +
         "\" stroke-width=\"" + (series.broad ? "5" : "1.8") + "\" stroke-linejoin=\"round\"" +
         (series.dashed ? " stroke-dasharray=\"6 4\"" : "") + " d=\"" + path_of(series, axes) +
         "\"/>\n";
}

std::string backdrop_of(const Backdrop& backdrop, const Axes& axes) {
  const Frame& f = axes.frame();
  return "<image x=\"" + coordinate(f.left) + "\" y=\"" + coordinate(f.top) + "\" width=\"" +
         coordinate(f.width) + "\" height=\"" + coordinate(f.height) +
         "\" preserveAspectRatio=\"none\" href=\"" + backdrop.image + "\"/>\n";
}

/// A bar of a round length in the lower left corner, for a dark picture.
std::string scale_bar(const Axes& axes) {
  const std::vector<double> ticks = round_ticks({0.0, 0.25 * axes.x().size()}, 3);
  const double length = ticks.back();
  const double x1 = axes.frame().left + 12.0;
  const double x2 = x1 + axes.px(length) - axes.px(0.0);
  const double y = axes.frame().top + axes.frame().height - 12.0;
  const std::string colour = "#fff";
  return "<path fill=\"none\" stroke=\"" + colour + "\" stroke-width=\"2\" d=\"M" + coordinate(x1) +
         " " + coordinate(y - 5.0) + "v5H" + coordinate(x2) + "v-5\"/>\n<text x=\"" +
         coordinate(0.5 * (x1 + x2)) + "\" y=\"" + coordinate(y - 7.0) +
         "\" font-size=\"12\" text-anchor=\"middle\" fill=\"" + colour + "\">" +
         tick_text(length, length) + " m</text>\n";
}

}  // namespace

std::string svg_of(const LineChart& chart) {
  Range x;
  Range y;
  find_ranges(chart, x, y);
  const double width = kAxesWidth;
  const double height = fit_height(chart, width, x, y);
  Legend legend;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    legend.push_back({chart.series[i].name,
                      colour_of(chart, i),
                      chart.series[i].points   ? Mark::kDot
                      : chart.series[i].dashed ? Mark::kDashes
                                               : Mark::kLine});
  }
  const PlacedLegend placed = place(legend, kAxesLeft, kAxesLeft + kAxesWidth);
  const Axes axes({kAxesLeft, placed.height + 26.0, width, height}, x, y);

  std::string body = placed.svg;
  if (chart.backdrop) {
    body += backdrop_of(*chart.backdrop, axes);
  }
  // Lines over a dark picture need no grid.
  std::string around = axes.svg(chart.x_label, chart.y_label);
  if (chart.backdrop) {
    around = "<g class=\"no-grid\">" + around + "</g>";
    const std::string stroke = "stroke=\"#ddd\"";
    around.replace(around.find(stroke), stroke.size(), "stroke=\"#fff\" opacity=\"0.12\"");
  }
  body += around;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& series = chart.series[i];
    body += series.points ? points_of(series, axes, colour_of(chart, i))
                          : line_of(series, axes, colour_of(chart, i));
  }
  if (chart.equal_scale && chart.backdrop) {
    body += scale_bar(axes);
  }
  return document(kDrawingWidth, placed.height + 26.0 + height + kBottom, chart.alt, body);
}

}  // namespace slamd::plot
