#pragma once

#include <string>
#include <vector>

namespace slamd::plot {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

/// One line of a chart, in the palette's next colour.
struct Series {
  std::string name;
  std::vector<PlotPoint> points;
};

struct ChartConfig {
  std::string title;
  std::string x_label;  // with its unit
  std::string y_label;
  bool equal_axes = false;  // one metre is as long in x as in y
  int width_px = 760;
  int height_px = 420;
};

/// Draws lines with axes, ticks, grid and legend, as an <svg> element that takes its text colour from the page.
/// Long series are thinned to what the picture can show.
std::string line_chart(const ChartConfig& config, const std::vector<Series>& series);

/// Puts charts below one another in one SVG file.
std::string stacked(const std::vector<std::string>& charts);

/// Returns the palette's colour for a series: told apart by colour-blind eyes, on white and on black.
/// Source: Okabe and Ito (2008).
const char* colour(std::size_t series);

/// Replaces what HTML and SVG would take for markup.
std::string escaped(const std::string& text);

}  // namespace slamd::plot
