#include "core/scan/features.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace slamd::scan {

using sensor::Point;

namespace {

float length_of(float x_m, float y_m, float z_m) { return std::sqrt(x_m * x_m + y_m * y_m + z_m * z_m); }

}  // namespace

FeatureClassifier::FeatureClassifier(const FeatureConfig& config, std::size_t max_points)
    : config_(config),
      order_(max_points),
      x_m_(max_points),
      y_m_(max_points),
      z_m_(max_points),
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
  const std::size_t places = line_begin_[kMaxLines];
  order_.resize(places);
  for (auto* array : {&x_m_, &y_m_, &z_m_, &range_m_, &roughness_m_}) {
    array->resize(places);
  }
  break_after_.resize(places);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (usable[i] != 0 && points[i].echo == 0) {
      const std::uint32_t place = next[points[i].line % kMaxLines]++;
      order_[place] = static_cast<std::uint32_t>(i);
      x_m_[place] = points[i].x_m;
      y_m_[place] = points[i].y_m;
      z_m_[place] = points[i].z_m;
      range_m_[place] = range_of(points[i]);
    }
  }
}

void FeatureClassifier::classify(std::span<const Point> points,
                                 std::span<const std::uint8_t> usable,
                                 std::span<Shape> shapes) {
  std::fill(shapes.begin(), shapes.end(), Shape::kUnknown);
  sort_by_line(points, usable);
  for (std::size_t i = 0; i < kMaxLines; ++i) {
    const Line line{line_begin_[i], line_begin_[i + 1]};
    if (line.size() > 2 * kNeighbours) {
      classify_line(line, shapes);
    }
  }
}

void FeatureClassifier::mark_breaks(const Line& line) {
  for (std::size_t i = line.begin; i + 1 < line.end; ++i) {
    const float nearer = std::min(range_m_[i], range_m_[i + 1]);
    const float limit = std::max(config_.break_floor_m, config_.break_slope * nearer);
    const float apart = length_of(x_m_[i] - x_m_[i + 1], y_m_[i] - y_m_[i + 1], z_m_[i] - z_m_[i + 1]);
    break_after_[i] = apart > limit ? 1 : 0;
  }
  break_after_[line.end - 1] = 1;
}

/// The length of Σ(p_j − p_i) over ±kNeighbours, wherever the line has them; whether all are of one object, nobody asks yet.
void FeatureClassifier::measure_roughness(const Line& line) {
  constexpr std::size_t kLanes = 8;
  using Lanes = Eigen::Array<float, kLanes, 1>;
  const auto at = [](const BoundedVector<float>& values, std::size_t i) {
    return Eigen::Map<const Lanes>(values.data() + i);
  };
  const std::size_t end = line.end - kNeighbours;
  std::size_t i = line.begin + kNeighbours;
  for (; i + kLanes <= end; i += kLanes) {
    const Lanes x = at(x_m_, i);
    const Lanes y = at(y_m_, i);
    const Lanes z = at(z_m_, i);
    Lanes sum_x = Lanes::Zero();
    Lanes sum_y = Lanes::Zero();
    Lanes sum_z = Lanes::Zero();
    for (std::size_t j = i - kNeighbours; j <= i + kNeighbours; ++j) {
      sum_x += at(x_m_, j) - x;
      sum_y += at(y_m_, j) - y;
      sum_z += at(z_m_, j) - z;
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const auto k = static_cast<Eigen::Index>(lane);
      roughness_m_[i + lane] = length_of(sum_x[k], sum_y[k], sum_z[k]);
    }
  }
  for (; i < end; ++i) {
    float sum[3] = {};
    for (std::size_t j = i - kNeighbours; j <= i + kNeighbours; ++j) {
      sum[0] += x_m_[j] - x_m_[i];
      sum[1] += y_m_[j] - y_m_[i];
      sum[2] += z_m_[j] - z_m_[i];
    }
    roughness_m_[i] = length_of(sum[0], sum[1], sum[2]);
  }
}

void FeatureClassifier::classify_line(const Line& line, std::span<Shape> shapes) {
  mark_breaks(line);
  measure_roughness(line);
  std::size_t run_begin = line.begin;  // first point of the current unbroken run
  std::size_t run_end = line.begin;    // one past its last
  for (std::size_t i = line.begin; i < line.end; ++i) {
    if (i == run_end) {
      run_begin = i;
      while (break_after_[run_end] == 0) {
        ++run_end;
      }
      ++run_end;
    }
    const float range = range_m_[i];
    if (i < run_begin + kNeighbours || i + kNeighbours >= run_end) {
      // A break edge: the near side of a jump in range. The far side's border is only where the near object ends.
      const bool first = i == run_begin && i > line.begin;
      const bool last = i + 1 == run_end && i + 1 < line.end;
      const bool nearer = (first && range < range_m_[i - 1] - config_.break_floor_m) ||
                          (last && range < range_m_[i + 1] - config_.break_floor_m);
      roughness_m_[i] = 0.0F;
      if (nearer && run_end - run_begin > kNeighbours) {
        shapes[order_[i]] = Shape::kEdge;
        roughness_m_[i] = range;
      }
      continue;
    }
    const float graze = config_.parallel_slope * range;
    const bool parallel =
        std::abs(range_m_[i - 1] - range) > graze && std::abs(range_m_[i + 1] - range) > graze;
    if (parallel) {
      continue;
    }
    if (roughness_m_[i] < config_.planar_floor_m + config_.planar_slope * range) {
      shapes[order_[i]] = Shape::kPlanar;
    } else if (roughness_m_[i] > config_.edge_floor_m + config_.edge_slope * range) {
      shapes[order_[i]] = Shape::kEdge;
    }
  }
  thin_edges(line, shapes);
}

void FeatureClassifier::thin_edges(const Line& line, std::span<Shape> shapes) {
  // Of edges within ±kNeighbours only the roughest stays: one per corner.
  for (std::size_t i = line.begin; i < line.end; ++i) {
    if (shapes[order_[i]] != Shape::kEdge) {
      continue;
    }
    const std::size_t begin = i < line.begin + kNeighbours ? line.begin : i - kNeighbours;
    const std::size_t end = std::min(line.end, i + kNeighbours + 1);
    for (std::size_t j = begin; j < end; ++j) {
      if (j != i && shapes[order_[j]] == Shape::kEdge && roughness_m_[j] > roughness_m_[i]) {
        shapes[order_[i]] = Shape::kUnknown;
        break;
      }
    }
  }
}

}  // namespace slamd::scan
