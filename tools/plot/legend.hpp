#pragma once

#include <string>
#include <vector>

namespace slamd::plot {

enum class Mark { kLine, kDashes, kDot, kBox };

struct LegendEntry {
  std::string name;
  std::string colour;
  Mark mark = Mark::kLine;
};

using Legend = std::vector<LegendEntry>;

/// A legend above a plot, broken into rows, as SVG, and the height that it takes.
struct PlacedLegend {
  std::string svg;
  double height = 0.0;
};

/// Places the entries that have a name between two verticals.
PlacedLegend place(const Legend& legend, double left, double right);

}  // namespace slamd::plot
