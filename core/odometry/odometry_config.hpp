#pragma once

#include <cmath>
#include <cstdint>

#include "core/geometry/se3.hpp"
#include "core/inertial/propagation.hpp"
#include "core/inertial/start_up_alignment.hpp"
#include "core/inertial/wheel_update.hpp"
#include "core/inertial/zero_velocity.hpp"
#include "core/map/voxel_map.hpp"
#include "core/odometry/iterated_update.hpp"
#include "core/psf/particle_swarm_filter.hpp"
#include "core/scan/preprocessor.hpp"

namespace slamd::odometry {

/// Which filter runs: the particle swarm filter, or its own ablation.
enum class Filter : std::uint8_t { kPsf, kIekf };

/// Where the robot is, as far as cell sizes and the little square are concerned.
enum class Environment : std::uint8_t { kAuto, kIndoor, kOutdoor };

/// Everything the odometry is built from. The defaults serve a ground vehicle with a MEMS inertial sensor.
struct OdometryConfig {
  Filter filter = Filter::kPsf;
  Environment environment = Environment::kAuto;
  std::uint64_t seed = 1;
  bool use_imu = true;                 // false: LiDAR only, at constant velocity
  Duration imu_offset{};               // by which inertial stamps are late: taken off
  geometry::Se3 T_base_imu;            // identity when LiDAR only
  geometry::Se3 T_base_lidar;
  inertial::ImuNoise imu_noise;
  inertial::ConstantVelocityNoise constant_velocity;
  inertial::WheelConfig wheel;
  inertial::StartUpConfig start_up;
  inertial::ZeroVelocityConfig zero_velocity;
  inertial::UnseenMotion unseen;
  scan::PreprocessConfig preprocess;
  map::VoxelMapConfig map;
  UpdateConfig update;
  psf::PsfConfig psf;
  double indoor_below_m = 8.0;         // median range of the last ten scans, with hysteresis
  double outdoor_above_m = 12.0;
  double min_inlier_ratio = 0.5;
  double min_matched_ratio = 0.25;
  double max_innovation = 60.0;        // squared Mahalanobis length; beyond, the prediction was wrong
  Duration max_imu_gap = std::chrono::milliseconds(50);
  Duration max_scan_gap = std::chrono::milliseconds(500);  // beyond, the map must confirm the pose before it grows
  double jump_m = 0.2;                 // a scan that corrects the inertial prediction by more: likewise
  double jump_rad = 2.0 * M_PI / 180.0;
  double confirming_matched_ratio = 0.5;  // of the features, in the map as it was
  int confirming_scans = 3;            // that agree in a row
  int lost_after = 20;                 // scans without a trustworthy update
  int lost_unconfirmed_after = 50;     // scans without confirmation
  double lost_position_std_m = 2.0;    // beyond it a recovery swarm does not search: without a scan the pose is lost
  double lost_rotation_std_rad = 20.0 * M_PI / 180.0;
  int restart_map_unmet_after = 10;    // scans that hardly meet the old map: there is nothing to wait for
  int restart_map_after = 200;         // then the map goes on where the pose is believed to be; it is said
  int say_restart_for = 100;           // scans
};

}  // namespace slamd::odometry
