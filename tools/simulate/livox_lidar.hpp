#pragma once

#include "tools/simulate/inertial_sensor.hpp"
#include "tools/simulate/risley.hpp"
#include "tools/simulate/spinning_lidar.hpp"

namespace slamd::simulate {

/// A Livox Avia in single-return mode: SDK1 packets of type 2, 96 firings each, each ray cast at its own time; and its
/// own inertial sensor in packets of type 6. Its clock counts from power-up.
class LivoxLidar {
 public:
  LivoxLidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar, const RangeErrors& errors,
             std::uint64_t seed);

  static constexpr double kPacket_s = 400e-6;
  static constexpr std::uint64_t kPowerUp_ns = 47'123'456'789;  // before the drive began
  static constexpr std::uint16_t kPort = 56001;

  /// Makes point packet number `index`; thread-safe, and the same whatever was made before.
  SentPacket point_packet(std::uint64_t index) const;

  /// Wraps a sample of the built-in sensor.
  SentPacket imu_packet(double t_s, const InertialReading& reading) const;

 private:
  std::vector<std::byte> header(double t_s, std::uint8_t data_type, std::size_t bytes) const;

  const World& world_;
  const Motion& motion_;
  geometry::Se3 T_base_lidar_;
  RangeErrors errors_;
  Noise noise_;
  Risley pattern_;
  double line_bias_m_[6];
};

}  // namespace slamd::simulate
