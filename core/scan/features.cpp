#include "core/scan/features.hpp"

#include <algorithm>
#include <cmath>

namespace slamd::scan {

using sensor::Point;

namespace {

float distance_between(const Point& a, const Point& b) {
  const float dx = a.x_m - b.x_m;
  const float dy = a.y_m - b.y_m;
  const float dz = a.z_m - b.z_m;
  return std::sqrt(dx * dx + dy * dy + dz * dz);
}

}  // namespace

FeatureClassifier::FeatureClassifier(const FeatureConfig& config, std::size_t max_points)
    : config_(config),
      order_(max_points),
      range_m_(max_points),
      roughness_m_(max_points),
      break_after_(max_points) {}

void FeatureClassifier::sort_by_line(std::span<const Point> points, std::span<const std::uint8_t> usable) {
  std::uint32_t count[kMaxLines] = {};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (usable[i] != 0 && points[i].echo == 0) {
      ++count[points[i].line % kMaxLines];
    }
  }
  line_begin_[0] = 0;
  for (std::size_t line = 0; line < kMaxLines; ++line) {
    line_begin_[line + 1] = line_begin_[line] + count[line];
  }
  std::uint32_t next[kMaxLines];
  std::copy(line_begin_, line_begin_ + kMaxLines, next);
  order_.resize(line_begin_[kMaxLines]);
  range_m_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (usable[i] != 0 && points[i].echo == 0) {
      order_[next[points[i].line % kMaxLines]++] = static_cast<std::uint32_t>(i);
      range_m_[i] = range_of(points[i]);
    }
  }
}

void FeatureClassifier::classify(std::span<const Point> points,
                                 std::span<const std::uint8_t> usable,
                                 std::span<Shape> shapes) {
  std::fill(shapes.begin(), shapes.end(), Shape::kUnknown);
  sort_by_line(points, usable);
  for (std::size_t line = 0; line < kMaxLines; ++line) {
    const std::span<const std::uint32_t> indices(order_.data() + line_begin_[line],
                                                 line_begin_[line + 1] - line_begin_[line]);
    if (indices.size() > 2 * kNeighbours) {
      classify_line(points, indices, shapes);
    }
  }
}

void FeatureClassifier::mark_breaks(std::span<const Point> points, std::span<const std::uint32_t> line) {
  break_after_.resize(line.size());
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const float nearer = std::min(range_m_[line[i]], range_m_[line[i + 1]]);
    const float limit = std::max(config_.break_floor_m, config_.break_slope * nearer);
    break_after_[i] = distance_between(points[line[i]], points[line[i + 1]]) > limit ? 1 : 0;
  }
  break_after_[line.size() - 1] = 1;
}

void FeatureClassifier::classify_line(std::span<const Point> points,
                                      std::span<const std::uint32_t> line,
                                      std::span<Shape> shapes) {
  mark_breaks(points, line);
  roughness_m_.resize(line.size());
  const std::size_t n = line.size();
  std::size_t run_begin = 0;  // first point of the current unbroken run
  std::size_t run_end = 0;    // one past its last
  for (std::size_t i = 0; i < n; ++i) {
    if (i == run_end) {
      run_begin = i;
      while (break_after_[run_end] == 0) {
        ++run_end;
      }
      ++run_end;
    }
    roughness_m_[i] = 0.0F;
    if (i < run_begin + kNeighbours || i + kNeighbours >= run_end) {
      // A break edge: the near side of a jump in range. The far side's border is only where the near object ends.
      const bool first = i == run_begin && i > 0;
      const bool last = i + 1 == run_end && i + 1 < n;
      const float range = range_m_[line[i]];
      const bool nearer = (first && range < range_m_[line[i - 1]] - config_.break_floor_m) ||
                          (last && range < range_m_[line[i + 1]] - config_.break_floor_m);
      if (nearer && run_end - run_begin > kNeighbours) {
        shapes[line[i]] = Shape::kEdge;
        roughness_m_[i] = range;
      }
      continue;
    }
    const Point& p = points[line[i]];
    float sum[3] = {};
    for (std::size_t j = i - kNeighbours; j <= i + kNeighbours; ++j) {
      sum[0] += points[line[j]].x_m - p.x_m;
      sum[1] += points[line[j]].y_m - p.y_m;
      sum[2] += points[line[j]].z_m - p.z_m;
    }
    const float range = range_m_[line[i]];
    const float roughness = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    const float graze = config_.parallel_slope * range;
    const bool parallel = std::abs(range_m_[line[i - 1]] - range) > graze &&
                          std::abs(range_m_[line[i + 1]] - range) > graze;
    roughness_m_[i] = roughness;
    if (parallel) {
      continue;
    }
    if (roughness < config_.planar_floor_m + config_.planar_slope * range) {
      shapes[line[i]] = Shape::kPlanar;
    } else if (roughness > config_.edge_floor_m + config_.edge_slope * range) {
      shapes[line[i]] = Shape::kEdge;
    }
  }
  thin_edges(line, shapes);
}

void FeatureClassifier::thin_edges(std::span<const std::uint32_t> line, std::span<Shape> shapes) {
  // Of edges within ±kNeighbours only the roughest stays: one per corner.
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (shapes[line[i]] != Shape::kEdge) {
      continue;
    }
    const std::size_t begin = i < kNeighbours ? 0 : i - kNeighbours;
    const std::size_t end = std::min(line.size(), i + kNeighbours + 1);
    for (std::size_t j = begin; j < end; ++j) {
      if (j != i && shapes[line[j]] == Shape::kEdge && roughness_m_[j] > roughness_m_[i]) {
        shapes[line[i]] = Shape::kUnknown;
        break;
      }
    }
  }
}

}  // namespace slamd::scan
