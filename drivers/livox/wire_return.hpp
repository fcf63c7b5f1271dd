#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/bytes.hpp"
#include "core/sensor/point_block.hpp"
#include "drivers/livox/imu_reading.hpp"

namespace slamd::livox {

/// Bytes of an inertial sample: six floats, the same in SDK1 and SDK2.
inline constexpr std::size_t kImuBytes = 24;

/// The direction of a spherical firing.
struct Direction {
  std::uint16_t zenith_cdeg = 0;   // from +z
  std::uint16_t azimuth_cdeg = 0;  // from +x towards +y

  bool valid() const { return zenith_cdeg <= 18000 && azimuth_cdeg <= 36000; }

  /// Frames: lidar.
  std::array<double, 3> unit_vector() const;
};

/// Three numbers of 32 bits, from the front of bytes.
inline std::array<std::int32_t, 3> load_xyz_mm(std::span<const std::byte> bytes) {
  return {load_le<std::int32_t>(bytes, 0), load_le<std::int32_t>(bytes, 4), load_le<std::int32_t>(bytes, 8)};
}

/// The closed interval of ranges that are given out.
struct RangeGate {
  double min_m = 0.0;
  double max_m = 0.0;
};

/// Tells whether the gate lets a return at p_lidar_m through, by std::hypot; where its square decides as well, by that.
inline bool is_within(const RangeGate& gate, const std::array<double, 3>& p_lidar_m) {
  constexpr double kRounding = 1e-12;  // of the squares, relative; a thousand times what it can be
  const double range_sq_m2 = p_lidar_m[0] * p_lidar_m[0] + p_lidar_m[1] * p_lidar_m[1] + p_lidar_m[2] * p_lidar_m[2];
  if (range_sq_m2 > gate.min_m * gate.min_m * (1.0 + kRounding) && range_sq_m2 < gate.max_m * gate.max_m * (1.0 - kRounding)) {
    return true;
  }
  const double range_m = std::hypot(p_lidar_m[0], p_lidar_m[1], p_lidar_m[2]);
  return !(range_m < gate.min_m || range_m > gate.max_m);
}

/// Puts a return at p_lidar_m into the block; false when the gate stops it.
inline bool append_within(const RangeGate& gate,
                          const std::array<double, 3>& p_lidar_m,
                          sensor::Point point,
                          sensor::PointBlock& block) {
  if (!is_within(gate, p_lidar_m)) {
    return false;
  }
  point.x_m = static_cast<float>(p_lidar_m[0]);
  point.y_m = static_cast<float>(p_lidar_m[1]);
  point.z_m = static_cast<float>(p_lidar_m[2]);
  block.points.push_back(point);
  return true;
}

/// Reads gyroscope (rad/s) and accelerometer (g, given as m/s²) into the reading; false when one of
/// the numbers is not finite.
bool read_imu(std::span<const std::byte> bytes, ImuReading& reading);

}  // namespace slamd::livox
