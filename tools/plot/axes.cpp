#include "tools/plot/axes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/plot/svg.hpp"

namespace slamd::plot {

namespace {

double round_step(double size, int count) {
  const double rough = size / std::max(1, count);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power * (1.0 + 1e-9)) {
      return factor * power;
    }
  }
  return 10.0 * power;
}

std::string line(double x1, double y1, double x2, double y2) {
  return "<line x1=\"" + coordinate(x1) + "\" y1=\"" + coordinate(y1) + "\" x2=\"" +
         coordinate(x2) + "\" y2=\"" + coordinate(y2) + "\"/>\n";
}

}  // namespace

void Range::include(double value) {
  if (std::isfinite(value)) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
}

void Range::widen(double share) {
  if (empty()) {
    *this = {0.0, 1.0};
  }
  // A constant still needs an axis around it.
  const double by = size() > 0.0 ? share * size() : std::max(0.5, 0.1 * std::abs(low));
  low -= by;
  high += by;
}

std::vector<double> round_ticks(const Range& range, int count) {
  std::vector<double> ticks;
  if (range.empty() || !(range.size() > 0.0)) {
    return ticks;
  }
  const double step = round_step(range.size(), count);
  for (double i = std::ceil(range.low / step - 1e-9); i * step <= range.high + 1e-9 * step; ++i) {
    ticks.push_back(i * step);
  }
  return ticks;
}

std::string tick_text(double value, double step) {
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  std::array<char, 64> text{};
  std::snprintf(
      text.data(), text.size(), "%.*f", digits, std::abs(value) < 1e-9 * step ? 0.0 : value);
  return text.data();
}

std::string Axes::svg(const std::string& x_label,
                      const std::string& y_label,
                      bool y_numbers) const {
  const double bottom = frame_.top + frame_.height;
  const double right = frame_.left + frame_.width;
  std::string grid = "<g class=\"grid\" stroke=\"#ddd\" stroke-width=\"1\">\n";
  std::string numbers;
  const std::vector<double> xs = round_ticks(x_, static_cast<int>(frame_.width / 70.0));
  for (const double x : xs) {
    grid += line(px(x), frame_.top, px(x), bottom);
    numbers += text_at(
        px(x), bottom + 17.0, tick_text(x, xs.size() > 1 ? xs[1] - xs[0] : x_.size()), "middle");
  }
  const std::vector<double> ys =
      y_numbers ? round_ticks(y_, std::max(3, static_cast<int>(frame_.height / 42.0)))
                : std::vector<double>{};
  for (const double y : ys) {
    grid += line(frame_.left, py(y), right, py(y));
    numbers += text_at(frame_.left - 6.0,
                       py(y) + 4.5,
                       tick_text(y, ys.size() > 1 ? ys[1] - ys[0] : y_.size()),
                       "end");
  }
  grid += "</g>\n";
  numbers += text_at(frame_.left + 0.5 * frame_.width, bottom + 36.0, x_label, "middle");
  if (!y_label.empty()) {
    numbers += text_at(frame_.left, frame_.top - 8.0, y_label, "start");
  }
  return grid + numbers;
}

}  // namespace slamd::plot
