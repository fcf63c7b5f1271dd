#pragma once

#include <string>
#include <utility>
#include <vector>

namespace slamd::plot {

/// What held from begin to end.
struct Span {
  double begin = 0.0;
  double end = 0.0;
  std::string kind;  // gives the colour and stands in the legend
  std::string note;  // shown where a mouse rests
};

struct TimelineRow {
  std::string name;
  std::vector<Span> spans;
};

/// Bands over time, a row for each.
struct Timeline {
  std::string alt;
  std::string x_label;
  std::vector<TimelineRow> rows;
  std::vector<std::pair<std::string, std::string>> colours;  // of the kinds, in the legend's order
};

/// Returns the timeline as one SVG element.
std::string svg_of(const Timeline& timeline);

}  // namespace slamd::plot
