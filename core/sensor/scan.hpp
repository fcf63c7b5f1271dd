#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/bounded_vector.hpp"
#include "core/base/stamp.hpp"
#include "core/sensor/point.hpp"

namespace slamd::sensor {

/// One revolution of a spinning sensor, or one period of a Livox.
/// Frames: points in lidar, each at its own time begin + offset_ns. A scan's pose is that at its end.
struct Scan {
  Scan() = default;
  explicit Scan(std::size_t max_points) : points(max_points) {}

  std::uint64_t index = 0;        // counts from 0 per sensor, without gaps but for scans that were dropped
  Stamp begin{};                  // first firing
  Stamp end{};                    // end of the period; the scan's pose belongs to this stamp
  bool points_have_time = true;   // false: already compensated (KITTI folders); never deskewed
  bool complete = true;           // false: packets are missing, or the scan was cut short
  std::uint32_t points_dropped = 0;  // returns beyond the capacity
  BoundedVector<Point> points;
};

}  // namespace slamd::sensor
