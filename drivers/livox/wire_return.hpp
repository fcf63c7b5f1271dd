#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

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
std::array<std::int32_t, 3> load_xyz_mm(std::span<const std::byte> bytes);

/// The closed interval of ranges that are given out.
struct RangeGate {
  double min_m = 0.0;
  double max_m = 0.0;
};

/// Puts a return at p_lidar_m into the block; false when the gate stops it.
bool append_within(const RangeGate& gate,
                   const std::array<double, 3>& p_lidar_m,
                   sensor::Point point,
                   sensor::PointBlock& block);

/// Reads gyroscope (rad/s) and accelerometer (g, given as m/s²) into the reading; false when one of
/// the numbers is not finite.
bool read_imu(std::span<const std::byte> bytes, ImuReading& reading);

}  // namespace slamd::livox
