#pragma once

#include <string>
#include <vector>

namespace slamd::plot {

/// One layer of a stack: a value for each x.
struct Layer {
  std::string name;
  std::vector<double> y;
};

/// Values that add up, over x: drawn as bars on each other. Long lists are put into bins, each
/// drawn at its mean.
struct StackedChart {
  std::string alt;
  std::string x_label;
  std::string y_label;
  std::vector<double> x;  // ascending
  std::vector<Layer> layers;
};

/// Returns the chart as one SVG element.
std::string svg_of(const StackedChart& chart);

}  // namespace slamd::plot
