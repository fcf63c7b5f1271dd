#pragma once

#include <memory>
#include <optional>

#include "core/base/stamp.hpp"
#include "core/sensor/imu_sample.hpp"
#include "core/sensor/wheel_sample.hpp"
#include "drivers/recording/packet.hpp"
#include "tools/simulate/drive.hpp"
#include "tools/simulate/mid360_lidar.hpp"
#include "tools/simulate/spinning_lidar.hpp"
#include "tools/simulate/wheel_sensor.hpp"

namespace slamd::simulate {

/// When simulated drives begin on the time base: 2026-09-21 14:13:20 UTC.
inline constexpr std::int64_t kStart_unix_s = 1'790'000'000;

/// Rate of truth.tum.
inline constexpr double kTruth_hz = 100.0;

/// Rate of odom.csv.
inline constexpr double kWheel_hz = 50.0;

/// How imu.csv writes its numbers.
inline constexpr const char* kRateFormat = "%.7f";   // rad/s
inline constexpr const char* kForceFormat = "%.6f";  // m/s²

/// How odom.csv writes its speeds and turn rates.
inline constexpr const char* kSpeedFormat = "%.5f";     // m/s
inline constexpr const char* kTurnRateFormat = "%.6f";  // rad/s

/// Who packets are sent to, as captures tell: 192.168.1.50.
inline constexpr std::uint32_t kHostAddress = 0xC0A80132;

Stamp stamp_at(double t_s);

/// A sent packet as it is received; its bytes stay where they are.
recording::Packet packet_of(const SentPacket& sent);

/// A reading with the decimals that imu.csv has.
sensor::ImuSample written_sample(double t_s, const InertialReading& reading);

/// A reading with the decimals that odom.csv has.
sensor::WheelSample written_sample(double t_s, const WheelReading& reading);

/// How a drive is ridden.
Ride ride_of(const Drive& drive);

/// A drive that can be looked at: its world, its motion and its LiDAR.
class Scene {
 public:
  explicit Scene(const Drive& drive);

  const Drive& drive() const { return drive_; }
  const World& world() const { return scenery_->world(); }
  const Route& route() const { return scenery_->route(); }
  const Motion& motion() const { return *motion_; }
  /// Lets a driven drive go on; nobody may look at it meanwhile.
  void extend(const Motion::Channels& control_point, double strength) { motion_->append(control_point, strength); }

  /// Up to when the sensors know the motion as it will stay.
  double known_s() const { return motion_->duration_s() - (drive_.driven ? 1e-3 : 0.0); }

  const Mounting& mounting() const { return mounting_; }
  const PacketMaker& lidar() const;

  /// How many point packets the drive has.
  std::uint64_t packets() const { return static_cast<std::uint64_t>(motion_->duration_s() / lidar().packet_s()); }

  const SpinningLidar* spinning() const { return spinning_ ? &*spinning_ : nullptr; }
  const LivoxLidar* avia() const { return avia_ ? &*avia_ : nullptr; }
  const Mid360Lidar* mid360() const { return mid360_ ? &*mid360_ : nullptr; }

  /// The external sensor.
  InertialSensor imu() const;

  double path_m() const;

 private:
  Drive drive_;
  Mounting mounting_;
  std::unique_ptr<Scenery> scenery_;
  std::unique_ptr<Motion> motion_;
  std::optional<SpinningLidar> spinning_;
  std::optional<LivoxLidar> avia_;
  std::optional<Mid360Lidar> mid360_;
};

}  // namespace slamd::simulate
