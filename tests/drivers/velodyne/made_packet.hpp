#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/sensor/point.hpp"
#include "drivers/velodyne/decoder.hpp"

namespace slamd::velodyne {

inline constexpr std::uint8_t kStrongest = 0x37;
inline constexpr std::uint8_t kLast = 0x38;
inline constexpr std::uint8_t kDual = 0x39;

/// Builds a data packet: twelve blocks without a return, 0.40° apart from 0° on.
class MadePacket {
 public:
  MadePacket(std::uint8_t return_mode, std::uint8_t product) : bytes_(Decoder::kPacketBytes) {
    for (std::size_t block = 0; block < 12; ++block) {
      store_le<std::uint16_t>(bytes_, 100 * block, 0xEEFF);
    }
    store_le(bytes_, 1204, return_mode);
    store_le(bytes_, 1205, product);
    turn(0, 40);
  }

  /// Sets the azimuths of all blocks, or pairs of blocks when there are two returns.
  MadePacket& turn(int first_cdeg, int step_cdeg) {
    const std::size_t stride = load_le<std::uint8_t>(bytes_, 1204) == kDual ? 2 : 1;
    for (std::size_t block = 0; block < 12; ++block) {
      azimuth(block, (first_cdeg + step_cdeg * static_cast<int>(block / stride) + 36000) % 36000);
    }
    return *this;
  }

  MadePacket& azimuth(std::size_t block, int azimuth_cdeg) {
    store_le(bytes_, 100 * block + 2, static_cast<std::uint16_t>(azimuth_cdeg));
    return *this;
  }

  MadePacket& put(std::size_t block, std::size_t channel, std::uint16_t distance, std::uint8_t reflectivity) {
    store_le(bytes_, 100 * block + 4 + 3 * channel, distance);
    store_le(bytes_, 100 * block + 4 + 3 * channel + 2, reflectivity);
    return *this;
  }

  /// The same return in every channel of every block.
  MadePacket& fill(std::uint16_t distance, std::uint8_t reflectivity) {
    for (std::size_t block = 0; block < 12; ++block) {
      for (std::size_t channel = 0; channel < 32; ++channel) {
        put(block, channel, distance, reflectivity);
      }
    }
    return *this;
  }

  MadePacket& stamp(std::uint32_t stamp_us) {
    store_le(bytes_, 1200, stamp_us);
    return *this;
  }

  MadePacket& byte(std::size_t at, int value) {
    bytes_.at(at) = static_cast<std::byte>(value);
    return *this;
  }

  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

/// Where a return lies, in double precision.  Units: m, degrees.
struct Direction {
  double range_m = 0.0;
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
};

inline Direction direction_of(const sensor::Point& point) {
  const double x = point.x_m;
  const double y = point.y_m;
  const double z = point.z_m;
  const double azimuth_deg = std::atan2(-y, x) * 180.0 / M_PI;
  return {std::sqrt(x * x + y * y + z * z),
          azimuth_deg < -0.005 ? azimuth_deg + 360.0 : azimuth_deg,
          std::atan2(z, std::hypot(x, y)) * 180.0 / M_PI};
}

}  // namespace slamd::velodyne
