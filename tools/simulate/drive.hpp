#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/imu/protocol.hpp"
#include "tools/simulate/beam.hpp"
#include "tools/simulate/faults.hpp"
#include "tools/simulate/gnss_sensor.hpp"
#include "tools/simulate/inertial_sensor.hpp"
#include "tools/simulate/livox_lidar.hpp"
#include "tools/simulate/scenery.hpp"
#include "tools/simulate/vehicle.hpp"
#include "tools/simulate/wheel_sensor.hpp"

namespace slamd::simulate {

enum class LidarKind { kVlp16, kVlp32c, kHdl32e, kLivoxAvia, kLivoxMid360 };

/// The name of a LiDAR as recording.toml spells it.
const char* name_of(LidarKind lidar);

/// What is to be simulated.
struct Drive {
  LidarKind lidar = LidarKind::kVlp16;
  std::uint64_t seed = 1;
  double duration_s = 60.0;
  double speed_mps = 1.6;
  double rest_s = 3.0;       // standing still at the start
  double imu_rate_hz = 200.0;
  int threads = 2;           // of the ray casting; the bytes are the same for any number

  std::string world = "town";
  std::filesystem::path mesh = {};                    // a PLY file in place of a world
  std::vector<Eigen::Vector2d> waypoints = {};        // in place of the world's tour; closed
  Extras extras = {};
  VehicleKind vehicle = VehicleKind::kAckermann;
  bool driven = false;                                // by velocity commands, as they come, in place of the tour
  double turn_rate_radps = 2.0944;
  double bumps_per_100m = 0.0;
  double vibration_mps2 = 0.0;
  bool dual = false;                                  // Velodyne: two returns
  LivoxReturns returns = LivoxReturns::kFirst;        // Avia; and the two below
  RisleyPattern pattern = RisleyPattern::kNonRepetitive;
  bool spherical = false;
  bool mixed_pixels = false;
  double drops_per_m = 0.0;
  std::optional<double> range_noise_m = std::nullopt;  // in place of the model's
  std::optional<double> beam_bias_m = std::nullopt;
  InertialErrors imu_errors{.gyro_per_degree_radps = 2e-5};
  WheelErrors wheel_errors = {};
  GnssErrors gnss_errors = {};
  std::optional<imu::Protocol> can = std::nullopt;    // inertial sensor and wheels on CAN, with this protocol: write can.log
  bool map = false;                                   // write true_map.ply
  std::optional<Faults> faults = std::nullopt;        // of what the sensors send
  bool localisability = false;                        // write localisability.csv
};

/// Where the sensors sit on the vehicle.
struct Mounting {
  geometry::Se3 T_base_lidar;
  geometry::Se3 T_base_imu;
  geometry::Se3 T_base_antenna;
};

Mounting mounting_of(LidarKind lidar);

/// The range errors of a drive's LiDAR.
RangeErrors range_errors_of(const Drive& drive);

/// Height of base above the floor.
double base_height_m(VehicleKind vehicle);

/// recording.toml of a drive.
std::string recording_toml(const Drive& drive);

/// simulation.json of a drive: every parameter that the bytes depend on.
std::string parameters_json(const Drive& drive);

}  // namespace slamd::simulate
