#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/plot/axes.hpp"

namespace slamd::plot {

/// A line, or single points, through (x[i], y[i]). NaN breaks a line.
struct Series {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
  std::string colour;  // #rrggbb; empty: the palette's next
  bool dashed = false;
  bool points = false;
  bool broad = false;  // a band for narrower lines to lie on
};

/// A picture that fills a rectangle of data coordinates, behind the lines.
struct Backdrop {
  Range x;
  Range y;
  std::string image;  // an address: data:image/png;base64,...
};

/// What to draw. Labels name quantity and unit: "time [s]".
struct LineChart {
  std::string alt;  // says in a sentence what is to be seen
  std::string x_label;
  std::string y_label;
  std::vector<Series> series;
  std::optional<Backdrop> backdrop;  // fixes the ranges
  bool equal_scale = false;          // a metre is as long in x as in y; on a backdrop with a scale bar
  bool from_zero = false;            // y begins at 0
  double y_stretch = 1.0;            // with equal_scale: y is drawn so many times longer
};

/// Returns the chart as one SVG element. Long lines are thinned to what the eye can see.
std::string svg_of(const LineChart& chart);

/// Width of every drawing: small enough that its text is readable on a phone; and where its axes begin and how wide they
/// are. Units: CSS px.
inline constexpr double kDrawingWidth = 560.0;
inline constexpr double kAxesLeft = 58.0;
inline constexpr double kAxesWidth = kDrawingWidth - kAxesLeft - 14.0;

}  // namespace slamd::plot
