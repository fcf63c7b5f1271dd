#include "tools/plot/point_picture.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace slamd::plot {

namespace {

constexpr std::size_t kHeights = 36;  // shades of height ...
constexpr std::size_t kDensities =
    7;  // ... times shades of density, and the background: 253 colours
constexpr Rgb kBackground = {15, 19, 24};
constexpr std::size_t kMaxHeight = 2400;

/// The range between two quantiles of the finite values. Reorders them.
Range between_quantiles(std::vector<float>& values, double low, double high) {
  Range range;
  std::erase_if(values, [](float value) { return !std::isfinite(value); });
  if (!values.empty()) {
    for (const double share : {low, high}) {
      const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), values.begin() + at, values.end());
      range.include(values[static_cast<std::size_t>(at)]);
    }
  }
  return range;
}

Range along(std::span<const Eigen::Vector3f> points,
            std::span<const Eigen::Vector3f> path,
            const Eigen::Vector3f& axis) {
  std::vector<float> values;
  values.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    values.push_back(p.dot(axis));
  }
  Range range = between_quantiles(values, 0.002, 0.998);
  for (const Eigen::Vector3f& p : path) {
    range.include(p.dot(axis));
  }
  return range;
}

std::vector<Rgb> palette() {
  std::vector<Rgb> colours = {kBackground};
  for (std::size_t h = 0; h < kHeights; ++h) {
    const Rgb full = height_colour(static_cast<double>(h) / (kHeights - 1));
    for (std::size_t d = 0; d < kDensities; ++d) {
      const double light = 0.55 + 0.45 * static_cast<double>(d) / (kDensities - 1);
      const auto dim = [&](std::uint8_t on, std::uint8_t off) {
        return static_cast<std::uint8_t>(off + light * (on - off));
      };
      colours.push_back(
          {dim(full.r, kBackground.r), dim(full.g, kBackground.g), dim(full.b, kBackground.b)});
    }
  }
  return colours;
}

/// What fell into each pixel.
struct Pixels {
  std::vector<float> highest;
  std::vector<std::uint16_t> count;
};

/// How large a point is drawn: sparse clouds would be dust otherwise.  Units: pixels.
int dot_size(std::size_t points, std::size_t pixels) {
  const double share = static_cast<double>(points) / static_cast<double>(pixels);
  return share < 0.05 ? 3 : share < 0.4 ? 2 : 1;
}

Pixels collect(std::span<const Eigen::Vector3f> points,
               const Camera& camera,
               const PointPicture& picture) {
  const auto width = static_cast<int>(picture.image.width);
  const auto height = static_cast<int>(picture.image.height);
  Pixels pixels{std::vector<float>(picture.image.width * picture.image.height, -1e30F),
                std::vector<std::uint16_t>(picture.image.width * picture.image.height, 0)};
  const int size = dot_size(points.size(), pixels.count.size());
  for (const Eigen::Vector3f& p : points) {
    const double u = (p.dot(camera.across) - picture.across.low) / picture.across.size() * width;
    const double v = (picture.up.high - p.dot(camera.up)) / picture.up.size() * height;
    if (!(u >= 0.0 && v >= 0.0 && u < width && v < height)) {
      continue;
    }
    for (int y = static_cast<int>(v); y < std::min(height, static_cast<int>(v) + size); ++y) {
      for (int x = static_cast<int>(u); x < std::min(width, static_cast<int>(u) + size); ++x) {
        const auto at = static_cast<std::size_t>(y * width + x);
        pixels.highest[at] = std::max(pixels.highest[at], p.z());
        pixels.count[at] = static_cast<std::uint16_t>(std::min(pixels.count[at] + 1, 65535));
      }
    }
  }
  return pixels;
}

/// A count that only few pixels exceed.
double dense_count(const Pixels& pixels) {
  std::vector<float> counts;
  for (const std::uint16_t count : pixels.count) {
    if (count > 0) {
      counts.push_back(count);
    }
  }
  const Range range = between_quantiles(counts, 0.0, 0.9);
  return range.empty() ? 1.0 : std::max(2.0, range.high);
}

}  // namespace

Window window_of(std::span<const Eigen::Vector3f> points,
                 std::span<const Eigen::Vector3f> path,
                 const Camera& camera) {
  if (points.empty() && path.empty()) {
    throw std::invalid_argument("there is nothing to be seen: no points and no path");
  }
  Window window{along(points, path, camera.across), along(points, path, camera.up)};
  const double margin = 0.03 * std::max(window.across.size(), window.up.size()) + 0.1;
  for (Range* range : {&window.across, &window.up}) {
    range->low -= margin;
    range->high += margin;
  }
  return window;
}

PointPicture picture_of(std::span<const Eigen::Vector3f> points,
                        const Camera& camera,
                        const Window& window,
                        std::size_t width) {
  PointPicture picture;
  picture.across = window.across;
  picture.up = window.up;
  const double ratio = camera.stretch * window.up.size() / window.across.size();
  picture.image.width = width;
  picture.image.height = std::clamp<std::size_t>(
      static_cast<std::size_t>(ratio * static_cast<double>(width)), 1, kMaxHeight);
  std::vector<float> heights;
  heights.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    heights.push_back(p.z());
  }
  picture.colour = between_quantiles(heights, 0.02, 0.98);
  if (picture.colour.empty() || !(picture.colour.size() > 0.0)) {
    picture.colour.widen(0.1);
  }
  const Pixels pixels = collect(points, camera, picture);
  const double dense = dense_count(pixels);
  picture.image.palette = palette();
  picture.image.pixels.resize(pixels.count.size(), 0);
  for (std::size_t i = 0; i < pixels.count.size(); ++i) {
    if (pixels.count[i] == 0) {
      continue;
    }
    const double share =
        std::clamp((pixels.highest[i] - picture.colour.low) / picture.colour.size(), 0.0, 1.0);
    const double density = std::min(1.0, std::log1p(pixels.count[i]) / std::log1p(dense));
    const auto h = static_cast<std::size_t>(std::lround(share * (kHeights - 1)));
    const auto d = static_cast<std::size_t>(std::lround(density * (kDensities - 1)));
    picture.image.pixels[i] = static_cast<std::uint8_t>(1 + h * kDensities + d);
  }
  return picture;
}

}  // namespace slamd::plot
