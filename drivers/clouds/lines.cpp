#include "drivers/clouds/lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace slamd::clouds {

namespace {

using sensor::Point;

constexpr double kRevolution_deg = 360.0;
constexpr double kNeighbour_deg = 5.0;   // two returns of one line, but for gaps
constexpr double kNeighbourShare = 0.9;  // of consecutive pairs, in a cloud ordered by line
constexpr double kSameDirectionShare =
    0.8;                                 // of them; KITTI: 0.996, an Avia or a thinned cloud: 0.5
constexpr double kFallBack_deg = 45.0;   // so much back towards the front is a new line
constexpr double kLineStart_deg = 30.0;  // near a line's start its first points may jitter ...
constexpr double kBehindStart_deg = 300.0;  // ... to the other side of the front
constexpr std::size_t kMinLines = 4;
constexpr std::size_t kElevationLines = 64;

double degrees(double rad) {
  return rad * (180.0 / M_PI);
}

double elevation_deg(const Point& p) {
  return degrees(std::atan2(p.z_m, std::hypot(p.x_m, p.y_m)));
}

/// Azimuth from the front, 0..360, growing in the direction in which the lines turn.
double azimuth_deg(const Point& p, double direction) {
  const double azimuth = direction * degrees(std::atan2(p.y_m, p.x_m));
  return azimuth < 0.0 ? azimuth + kRevolution_deg : azimuth;
}

/// +1: counterclockwise seen from above, -1: clockwise, 0: the cloud is not ordered by line.
double turning_direction(std::span<const Point> points) {
  std::size_t neighbours = 0;
  std::size_t forward = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double step = std::remainder(
        azimuth_deg(points[i], 1.0) - azimuth_deg(points[i - 1], 1.0), kRevolution_deg);
    neighbours += std::abs(step) < kNeighbour_deg ? 1 : 0;
    forward += step > 0.0 ? 1 : 0;
  }
  const auto count = static_cast<double>(points.size());
  const double forward_share = static_cast<double>(forward) / std::max(count, 1.0);
  if (static_cast<double>(neighbours) < kNeighbourShare * count ||
      std::max(forward_share, 1.0 - forward_share) < kSameDirectionShare) {
    return 0.0;
  }
  return forward_share > 0.5 ? 1.0 : -1.0;
}

/// Finds where one line ends and the next begins.
class LineSplitter {
 public:
  explicit LineSplitter(double direction) : direction_(direction) {}

  /// Returns the line of the next point.
  std::size_t line_of(const Point& p) {
    const double azimuth = azimuth_deg(p, direction_);
    if (progress_ < kLineStart_deg && azimuth > kBehindStart_deg) {
      return line_;
    }
    if (azimuth < progress_ - kFallBack_deg) {
      ++line_;
      progress_ = azimuth;
    }
    progress_ = std::max(progress_, azimuth);
    return line_;
  }

 private:
  double direction_;
  double progress_ = 0.0;
  std::size_t line_ = 0;
};

}  // namespace

bool set_lines_by_firing_order(std::span<Point> points) {
  const double direction = turning_direction(points);
  if (direction == 0.0) {
    return false;
  }
  LineSplitter counting(direction);
  std::size_t last_line = 0;
  std::array<double, 2> elevation_sum_deg{};  // of the first and the second half of the points
  for (std::size_t i = 0; i < points.size(); ++i) {
    last_line = counting.line_of(points[i]);
    elevation_sum_deg[2 * i / points.size()] += elevation_deg(points[i]);
  }
  if (last_line + 1 < kMinLines || last_line >= kMaxGuessedLines) {
    return false;
  }
  const bool downwards = elevation_sum_deg[1] < elevation_sum_deg[0];
  LineSplitter setting(direction);
  for (Point& point : points) {
    const std::size_t line = setting.line_of(point);
    point.line = static_cast<std::uint8_t>(downwards ? last_line - line : line);
  }
  return true;
}

void set_lines_by_elevation(std::span<Point> points) {
  double lowest_deg = 90.0;
  double highest_deg = -90.0;
  for (const Point& point : points) {
    lowest_deg = std::min(lowest_deg, elevation_deg(point));
    highest_deg = std::max(highest_deg, elevation_deg(point));
  }
  const double step_deg = std::max(highest_deg - lowest_deg, 1e-3) / kElevationLines;
  for (Point& point : points) {
    const auto line = static_cast<std::size_t>((elevation_deg(point) - lowest_deg) / step_deg);
    point.line = static_cast<std::uint8_t>(std::min(line, kElevationLines - 1));
  }
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
    if (a.line != b.line) {
      return a.line < b.line;
    }
    return std::atan2(a.y_m, a.x_m) < std::atan2(b.y_m, b.x_m);
  });
}

}  // namespace slamd::clouds
