#pragma once

#include "tools/simulate/beam.hpp"
#include "tools/simulate/inertial_sensor.hpp"
#include "tools/simulate/motion.hpp"
#include "tools/simulate/sent_packet.hpp"

namespace slamd::simulate {

/// A Livox Mid-360: SDK2 packets of type 1 with their checksum, and its own inertial sensor in packets of type 0.
/// Its scan pattern is not published; this one covers the published field of view (360° × −7°…52°) without repeating
/// itself: a turning mirror whose elevation swings at a rate of no relation to the turning.
class Mid360Lidar : public PacketMaker {
 public:
  Mid360Lidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar, const RangeErrors& errors,
              std::uint64_t seed);

  static constexpr double kFirings_hz = 200'000.0;
  static constexpr std::uint64_t kPowerUp_ns = 31'415'926'535;
  static constexpr std::uint16_t kPointPort = 56301;
  static constexpr std::uint16_t kImuPort = 56401;
  static constexpr std::uint64_t kFirings = 96;

  SentPacket packet(std::uint64_t index) const override;
  double packet_s() const override { return static_cast<double>(kFirings) / kFirings_hz; }
  std::uint64_t shots() const override { return kFirings; }
  Eigen::Vector3d beam(double t_s, std::uint64_t shot) const override {
    return direction(t_s + static_cast<double>(shot) / kFirings_hz, static_cast<int>(shot % 4));
  }

  SentPacket imu_packet(double t_s, std::uint64_t index, const InertialReading& reading) const;

  /// The built-in sensor's place; its axes are the lidar's.
  static geometry::Se3 T_lidar_imu() { return {Eigen::Matrix3d::Identity(), {0.011, 0.02329, -0.04412}}; }

  /// Frames: unit vector in lidar.
  Eigen::Vector3d direction(double t_s, int line) const;

 private:
  const Motion& motion_;
  geometry::Se3 T_base_lidar_;
  Noise noise_;
  Beam beam_;
};

/// CRC-32 as zlib computes it (polynomial 0xEDB88320 reflected).
std::uint32_t crc32_of(std::span<const std::byte> bytes);

}  // namespace slamd::simulate
