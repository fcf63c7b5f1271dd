#include "tools/plot/legend.hpp"

#include <algorithm>

#include "tools/plot/svg.hpp"

namespace slamd::plot {

namespace {

constexpr double kRow = 20.0;
constexpr double kMarkWidth = 22.0;

std::string mark_at(double x, double y, const LegendEntry& entry) {
  const std::string paint = "=\"" + entry.colour + "\"";
  switch (entry.mark) {
    case Mark::kDot:
      return "<circle r=\"4\" cx=\"" + coordinate(x + 10.0) + "\" cy=\"" + coordinate(y) +
             "\" fill" + paint + "/>\n";
    case Mark::kBox:
      return "<rect width=\"14\" height=\"10\" x=\"" + coordinate(x + 4.0) + "\" y=\"" +
             coordinate(y - 5.0) + "\" fill" + paint + "/>\n";
    case Mark::kLine:
    case Mark::kDashes:
      break;
  }
  return "<path stroke-width=\"3\" d=\"M" + coordinate(x) + " " + coordinate(y) + "h18\" stroke" +
         paint + (entry.mark == Mark::kDashes ? " stroke-dasharray=\"6 4\"" : "") + "/>\n";
}

/// About how wide a text is: fonts differ, and a legend may be a little loose.
double width_of(const std::string& text) {
  const auto characters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  });
  return 7.4 * static_cast<double>(characters);
}

}  // namespace

PlacedLegend place(const Legend& legend, double left, double right) {
  PlacedLegend placed;
  double x = left;
  for (const LegendEntry& entry : legend) {
    if (entry.name.empty()) {
      continue;
    }
    const double width = kMarkWidth + width_of(entry.name) + 14.0;
    if (placed.height == 0.0 || x + width > right) {
      placed.height += kRow;
      x = left;
    }
    const double y = placed.height - 7.0;
    placed.svg += mark_at(x, y, entry) + text_at(x + kMarkWidth, y + 4.5, entry.name, "start");
    x += width;
  }
  return placed;
}

}  // namespace slamd::plot
