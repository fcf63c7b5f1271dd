#include "tools/plot/svg.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace slamd::plot {

namespace {

constexpr double kLeft = 68.0;
constexpr double kRight = 14.0;
constexpr double kTop = 34.0;
constexpr double kBottom = 46.0;
constexpr std::size_t kMaxPoints = 3000;

struct Range {
  double min = 0.0;
  double max = 1.0;
  double span() const { return max - min; }
};

std::string format(const char* pattern, double a) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, a);
  return text;
}

std::string pair_of(double a, double b) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1f,%.1f", a, b);
  return text;
}

Range range_of(const std::vector<Series>& series, double PlotPoint::* coordinate) {
  Range range{1e300, -1e300};
  for (const Series& line : series) {
    for (const PlotPoint& p : line.points) {
      range.min = std::min(range.min, p.*coordinate);
      range.max = std::max(range.max, p.*coordinate);
    }
  }
  if (range.min > range.max) {
    return {};
  }
  const double margin = std::max(0.04 * range.span(), 1e-9 + 1e-6 * std::abs(range.max));
  return {range.min - margin, range.max + margin};
}

/// A step of 1, 2 or 5 times a power of ten that gives about `count` ticks.
double tick_step(const Range& range, int count) {
  const double raw = range.span() / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double lead = raw / power;
  return power * (lead < 1.5 ? 1.0 : (lead < 3.5 ? 2.0 : (lead < 7.5 ? 5.0 : 10.0)));
}

/// Where values go on the picture.
struct Frame {
  Range x;
  Range y;
  double width;
  double height;

  double px(double v) const { return kLeft + (v - x.min) / x.span() * width; }
  double py(double v) const { return kTop + height - (v - y.min) / y.span() * height; }
};

void make_equal(Frame& frame) {
  const double scale = std::max(frame.x.span() / frame.width, frame.y.span() / frame.height);
  const auto widen = [&](Range& range, double pixels) {
    const double middle = 0.5 * (range.min + range.max);
    range = {middle - 0.5 * scale * pixels, middle + 0.5 * scale * pixels};
  };
  widen(frame.x, frame.width);
  widen(frame.y, frame.height);
}

std::string axes(const ChartConfig& config, const Frame& frame) {
  std::string svg;
  const auto tick = [&](double value, bool along_x) {
    const double at = along_x ? frame.px(value) : frame.py(value);
    const std::string label = format("%g", std::abs(value) < 1e-12 * (along_x ? frame.x.span() : frame.y.span()) ? 0.0 : value);
    if (along_x) {
      svg += "<line x1='" + format("%.1f", at) + "' x2='" + format("%.1f", at) + "' y1='" + format("%.1f", kTop) + "' y2='" +
             format("%.1f", kTop + frame.height) + "' stroke='currentColor' stroke-opacity='.13'/><text x='" + format("%.1f", at) +
             "' y='" + format("%.1f", kTop + frame.height + 17) + "' text-anchor='middle'>" + label + "</text>";
    } else {
      svg += "<line y1='" + format("%.1f", at) + "' y2='" + format("%.1f", at) + "' x1='" + format("%.1f", kLeft) + "' x2='" +
             format("%.1f", kLeft + frame.width) + "' stroke='currentColor' stroke-opacity='.13'/><text x='" + format("%.1f", kLeft - 7) +
             "' y='" + format("%.1f", at + 4) + "' text-anchor='end'>" + label + "</text>";
    }
  };
  const double step_x = tick_step(frame.x, 8);
  for (double v = std::ceil(frame.x.min / step_x) * step_x; v <= frame.x.max; v += step_x) {
    tick(v, true);
  }
  const double step_y = tick_step(frame.y, 6);
  for (double v = std::ceil(frame.y.min / step_y) * step_y; v <= frame.y.max; v += step_y) {
    tick(v, false);
  }
  svg += "<text x='" + format("%.1f", kLeft + 0.5 * frame.width) + "' y='" + format("%.1f", kTop + frame.height + 38) +
         "' text-anchor='middle'>" + escaped(config.x_label) + "</text>";
  svg += "<text transform='translate(14 " + format("%.1f", kTop + 0.5 * frame.height) + ") rotate(-90)' text-anchor='middle'>" +
         escaped(config.y_label) + "</text>";
  return svg;
}

}  // namespace

const char* colour(std::size_t series) {
  static const char* const palette[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};
  return palette[series % 6];
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      case '\'': result += "&#39;"; break;
      default: result += c;
    }
  }
  return result;
}

std::string line_chart(const ChartConfig& config, const std::vector<Series>& series) {
  Frame frame{range_of(series, &PlotPoint::x), range_of(series, &PlotPoint::y), config.width_px - kLeft - kRight,
              config.height_px - kTop - kBottom};
  if (config.equal_axes) {
    make_equal(frame);
  }
  std::string svg = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 " + std::to_string(config.width_px) + " " +
                    std::to_string(config.height_px) + "' role='img' aria-label='" + escaped(config.title) +
                    "' font-family='system-ui, sans-serif' font-size='12' fill='currentColor'>";
  svg += "<text x='" + format("%.1f", kLeft) + "' y='20' font-size='14' font-weight='600'>" + escaped(config.title) + "</text>";
  svg += axes(config, frame);
  double legend = config.width_px - kRight;
  for (std::size_t i = series.size(); i-- > 0;) {
    const Series& line = series[i];
    const std::size_t step = std::max<std::size_t>(1, line.points.size() / kMaxPoints);
    std::string points;
    for (std::size_t k = 0; k < line.points.size(); k += step) {
      points += pair_of(frame.px(line.points[k].x), frame.py(line.points[k].y)) + " ";
    }
    svg += "<polyline fill='none' stroke-width='1.6' stroke-linejoin='round' stroke='" + std::string(colour(i)) + "' points='" + points + "'/>";
    if (series.size() > 1) {
      legend -= 7.2 * static_cast<double>(line.name.size()) + 30.0;
      svg += "<rect x='" + format("%.1f", legend) + "' y='11' width='14' height='4' fill='" + colour(i) + "'/><text x='" +
             format("%.1f", legend + 19) + "' y='17'>" + escaped(line.name) + "</text>";
    }
  }
  return svg + "</svg>";
}

std::string stacked(const std::vector<std::string>& charts) {
  constexpr int kHeight = 430;
  std::string svg = "<svg xmlns='http://www.w3.org/2000/svg' width='760' height='" + std::to_string(kHeight * static_cast<int>(charts.size())) +
                    "' style='background:#fff;color:#222'>";
  for (std::size_t i = 0; i < charts.size(); ++i) {
    svg += "<svg y='" + std::to_string(kHeight * static_cast<int>(i)) + "' width='760' height='420' color='#222'>" + charts[i] + "</svg>";
  }
  return svg + "</svg>\n";
}

}  // namespace slamd::plot
