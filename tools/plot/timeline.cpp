#include "tools/plot/timeline.hpp"

#include <algorithm>
#include <set>

#include "tools/plot/axes.hpp"
#include "tools/plot/legend.hpp"
#include "tools/plot/line_chart.hpp"
#include "tools/plot/svg.hpp"

namespace slamd::plot {

namespace {

constexpr double kRow = 34.0;

std::string colour_of(const Timeline& timeline, const std::string& kind) {
  for (const auto& [name, colour] : timeline.colours) {
    if (name == kind) {
      return colour;
    }
  }
  return "#888888";
}

Legend legend_of(const Timeline& timeline) {
  std::set<std::string> kinds;
  for (const TimelineRow& row : timeline.rows) {
    for (const Span& span : row.spans) {
      kinds.insert(span.kind);
    }
  }
  Legend legend;
  for (const auto& [name, colour] : timeline.colours) {
    if (kinds.erase(name) == 1) {
      legend.push_back({name, colour, Mark::kBox});
    }
  }
  for (const std::string& kind : kinds) {
    legend.push_back({kind, colour_of(timeline, kind), Mark::kBox});
  }
  return legend;
}

}  // namespace

std::string svg_of(const Timeline& timeline) {
  Range x;
  for (const TimelineRow& row : timeline.rows) {
    for (const Span& span : row.spans) {
      x.include(span.begin);
      x.include(span.end);
    }
  }
  x.widen(0.0);
  const PlacedLegend placed = place(legend_of(timeline), kAxesLeft, kAxesLeft + kAxesWidth);
  const double height = kRow * static_cast<double>(timeline.rows.size());
  const Axes axes({kAxesLeft, placed.height + 10.0, kAxesWidth, height}, x, {0.0, 1.0});
  std::string body = placed.svg + axes.svg(timeline.x_label, "", false);
  double top = axes.frame().top + 5.0;
  for (const TimelineRow& row : timeline.rows) {
    body += text_at(kAxesLeft - 6.0, top + 0.5 * kRow, row.name, "end");
    for (const Span& span : row.spans) {
      // A span of one scan must still be seen.
      const double width = std::max(1.5, axes.px(span.end) - axes.px(span.begin));
      body += "<rect x=\"" + coordinate(axes.px(span.begin)) + "\" y=\"" + coordinate(top) +
              "\" width=\"" + coordinate(width) + "\" height=\"" + coordinate(kRow - 10.0) +
              "\" fill=\"" + colour_of(timeline, span.kind) + "\"><title>" + escaped(span.note) +
              "</title></rect>\n";
    }
    top += kRow;
  }
  return document(kDrawingWidth, placed.height + 10.0 + height + 46.0, timeline.alt, body);
}

}  // namespace slamd::plot
