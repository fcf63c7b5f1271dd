#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/se3.hpp"

namespace slamd::loop {

/// A place as Loop-Net sees it: how many points lie in each cell of a polar grid around a keyframe, as
/// round(32 log2(1 + n)), 255 at most. 38,400 bytes.
/// Frames: level, that is base turned upright: its origin, z against gravity, x the heading of base.
/// Shapes: 8 height slices × 40 rings of equal ratio from 0.8 m to 60 m × 120 azimuths of 3°, counted from x towards y.
struct PolarImage {
  static constexpr std::size_t kSlices = 8;
  static constexpr std::size_t kRings = 40;
  static constexpr std::size_t kAzimuths = 120;
  static constexpr std::size_t kCells = kSlices * kRings * kAzimuths;
  static constexpr float kNearest_m = 0.8F;
  static constexpr float kFarthest_m = 60.0F;
  /// Heights above base at which one slice ends and the next begins.  Units: m.
  static constexpr std::array<float, kSlices - 1> kSliceTops_m{-1.2F, -0.6F, 0.0F, 0.6F, 1.4F, 2.6F, 5.0F};

  static constexpr std::size_t index(std::size_t slice, std::size_t ring, std::size_t azimuth) {
    return (slice * kRings + ring) * kAzimuths + azimuth;
  }

  std::array<std::uint8_t, kCells> cells{};
};

/// Returns T_odom_level of a keyframe: its position and heading, upright.
/// Frames: odom's z is against gravity. A base that looks straight up or down has no heading; it gets one all the same.
geometry::Se3 level_of(const geometry::Se3& T_odom_base);

/// Makes polar images: the one featuriser, of the trainer and of the daemon.
/// Real-time: allocates in the constructor only; about 20 ns a point.
class PolarImager {
 public:
  PolarImager();

  /// Forgets all points.
  void clear();

  /// Adds points of a keyframe's submap, given in any frame, thinned or not; those nearer than 0.8 m or farther than 60 m
  /// in the plane, or that are no numbers, are left out.
  /// Frames: T_level_points takes them to the keyframe's level frame.  Units: m.
  void add(const geometry::Se3& T_level_points, std::span<const Eigen::Vector3f> points);

  /// Writes the image of the points so far.
  void finish(PolarImage& image) const;

 private:
  std::vector<std::uint8_t> counts_;  // of points by cell, 255 at most; sized once
};

}  // namespace slamd::loop
