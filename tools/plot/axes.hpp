#pragma once

#include <limits>
#include <string>
#include <vector>

namespace slamd::plot {

/// An interval of data values, empty at first.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(low <= high); }

  double size() const { return high - low; }

  void include(double value);
  void widen(double share);  // at both ends, by a share of its size
};

/// Returns round numbers (1, 2 or 5 times a power of ten apart) inside the range: about `count` of
/// them.
std::vector<double> round_ticks(const Range& range, int count);

/// Writes a tick with as many digits as ticks so far apart need.
std::string tick_text(double value, double step);

/// A rectangle of the drawing, y growing downwards.  Units: the drawing's.
struct Frame {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
};

/// Maps data to the drawing and draws what surrounds a plot.
class Axes {
 public:
  Axes(const Frame& frame, const Range& x, const Range& y) : frame_(frame), x_(x), y_(y) {}

  double px(double x) const { return frame_.left + frame_.width * (x - x_.low) / x_.size(); }

  double py(double y) const { return frame_.top + frame_.height * (y_.high - y) / y_.size(); }

  const Frame& frame() const { return frame_; }

  const Range& x() const { return x_; }

  const Range& y() const { return y_; }

  /// Returns grid lines with their numbers, and the labels, as SVG. Where y has no numbers, only
  /// its label is drawn.
  std::string svg(const std::string& x_label,
                  const std::string& y_label,
                  bool y_numbers = true) const;

 private:
  Frame frame_;
  Range x_;
  Range y_;
};

}  // namespace slamd::plot
