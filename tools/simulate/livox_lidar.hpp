#pragma once

#include <span>

#include "tools/simulate/beam.hpp"
#include "tools/simulate/inertial_sensor.hpp"
#include "tools/simulate/motion.hpp"
#include "tools/simulate/risley.hpp"
#include "tools/simulate/sent_packet.hpp"

namespace slamd::simulate {

/// Which echoes an Avia sends.
enum class LivoxReturns { kFirst, kStrongest, kDual, kTriple };

/// What an Avia is set to.
struct LivoxSettings {
  LivoxReturns returns = LivoxReturns::kFirst;
  RisleyPattern pattern = RisleyPattern::kNonRepetitive;
  bool spherical = false;  // depth and angles of 0.01° in place of x, y, z
};

/// A Livox Avia: SDK1 packets of cartesian points (data types 2, 4 and 7) or spherical ones (3, 5 and 8), each shot cast
/// at its own time; and its own inertial sensor in packets of type 6. Its clock counts from power-up.
class LivoxLidar : public PacketMaker {
 public:
  LivoxLidar(const World& world, const Motion& motion, const geometry::Se3& T_base_lidar, const RangeErrors& errors,
             std::uint64_t seed, const LivoxSettings& settings = {});

  static constexpr double kFirings_hz = 240'000.0;
  static constexpr std::uint64_t kPowerUp_ns = 47'123'456'789;  // before the drive began
  static constexpr std::uint16_t kPort = 56001;

  SentPacket packet(std::uint64_t index) const override { return point_packet(index); }
  SentPacket point_packet(std::uint64_t index) const;
  double packet_s() const override { return static_cast<double>(shots()) / kFirings_hz; }
  std::uint64_t shots() const override { return echoes() == 1 ? 96 : echoes() == 2 ? 48 : 30; }
  Eigen::Vector3d beam(double t_s, std::uint64_t shot) const override {
    return pattern_.direction(t_s + static_cast<double>(shot) / kFirings_hz, static_cast<int>(shot % 6));
  }

  /// Wraps a sample of the built-in sensor.
  SentPacket imu_packet(double t_s, const InertialReading& reading) const;

  /// The built-in sensor's place; its axes are the lidar's.
  static geometry::Se3 T_lidar_imu() { return {Eigen::Matrix3d::Identity(), {-0.04165, -0.02326, 0.0284}}; }

 private:
  std::uint64_t echoes() const {
    return settings_.returns == LivoxReturns::kTriple ? 3 : settings_.returns == LivoxReturns::kDual ? 2 : 1;
  }
  std::uint8_t data_type() const;
  std::size_t firing_bytes() const;
  void store(std::span<std::byte> firing, const Echoes& found, const Eigen::Vector3d& d_lidar) const;
  SentPacket packet_with_header(double t_s, std::uint8_t data_type, std::size_t bytes) const;

  const Motion& motion_;
  geometry::Se3 T_base_lidar_;
  Noise noise_;
  Beam beam_;
  LivoxSettings settings_;
  Risley pattern_;
  double line_bias_m_[6];
};

}  // namespace slamd::simulate
