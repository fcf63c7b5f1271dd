#pragma once

#include <cmath>
#include <cstdint>

namespace slamd::sensor {

/// One LiDAR return, as the decoder gives it.
/// Frames: x_m, y_m, z_m in lidar.  Units: m; offset_ns from the stamp of the block or scan that holds the point.
struct Point {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  std::uint32_t offset_ns = 0;
  std::uint8_t intensity = 0;  // the sensor's own reflectivity scale
  std::uint8_t line = 0;       // ring (0 lowest) of a spinning sensor, laser line of a Livox
  std::uint8_t tag = 0;        // as in Livox SDK1: return number, noise; 0 for sensors without one
  std::uint8_t echo = 0;       // 0 first or only return of its firing, 1 second, 2 third
};

static_assert(sizeof(Point) == 20);

/// Tells how far a return is from the sensor. Units: m.
inline float range_of(const Point& p) { return std::sqrt(p.x_m * p.x_m + p.y_m * p.y_m + p.z_m * p.z_m); }

}  // namespace slamd::sensor
