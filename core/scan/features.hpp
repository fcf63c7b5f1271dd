#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/bounded_vector.hpp"
#include "core/sensor/point.hpp"

namespace slamd::scan {

/// What a point looks like among its neighbours on the same line.
enum class Shape : std::uint8_t {
  kUnknown,  // too few neighbours, occluded, or seen at a grazing angle
  kPlanar,
  kEdge,
};

/// Thresholds of the classification. Roughness is the length of Σ(p_j − p_i) over ±kNeighbours on the line; both
/// thresholds are a noise floor plus a share of the range.
struct FeatureConfig {
  float planar_floor_m = 0.25F;
  float planar_slope = 0.015F;
  float edge_floor_m = 0.6F;
  float edge_slope = 0.04F;
  float break_floor_m = 0.25F;  // two neighbours further apart than this lie on different objects
  float break_slope = 0.06F;
  float parallel_slope = 0.02F;  // both neighbours' ranges differ by more: the beam grazes the surface
};

/// Classifies the points of a scan line by line (VLP-16 ring, or Livox line).
/// Source: curvature and occlusion tests after LOAM (Zhang and Singh, 2014); range-relative thresholds after
/// LIO-Livox; one extractor for rings and rosettes.
/// Real-time: allocates in the constructor only; O(points).
class FeatureClassifier {
 public:
  static constexpr std::size_t kMaxLines = 128;
  static constexpr int kNeighbours = 5;

  FeatureClassifier(const FeatureConfig& config, std::size_t max_points);

  /// Writes the shape of each point. Only first echoes that `usable` marks take part; the others stay kUnknown.
  /// Frames: points in lidar, in firing order.  Shapes: usable[N], shapes[N].
  void classify(std::span<const sensor::Point> points,
                std::span<const std::uint8_t> usable,
                std::span<Shape> shapes);

 private:
  /// The places of a line's points, in firing order: `order_` and all arrays after it are by place.
  struct Line {
    std::size_t begin;
    std::size_t end;
    std::size_t size() const { return end - begin; }
  };

  void sort_by_line(std::span<const sensor::Point> points, std::span<const std::uint8_t> usable);
  void classify_line(const Line& line, std::span<Shape> shapes);
  void mark_breaks(const Line& line);
  void measure_roughness(const Line& line);
  void thin_edges(const Line& line, std::span<Shape> shapes);

  FeatureConfig config_;
  // scratch, sized once
  BoundedVector<std::uint32_t> order_;       // point indices, line after line, in firing order
  BoundedVector<float> x_m_, y_m_, z_m_;     // side by side for vector instructions
  BoundedVector<float> range_m_;
  BoundedVector<float> roughness_m_;
  BoundedVector<std::uint8_t> break_after_;  // the next point of the line lies on another object
  std::uint32_t line_begin_[kMaxLines + 1] = {};
};

}  // namespace slamd::scan
