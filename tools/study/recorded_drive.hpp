#pragma once

#include <string>
#include <vector>

#include "core/inertial/start_up_alignment.hpp"
#include "core/odometry/odometry_config.hpp"
#include "core/scan/preprocessor.hpp"
#include "core/sensor/imu_sample.hpp"
#include "tools/simulate/drive.hpp"

namespace slamd::study {

/// A simulated drive as the odometry gets it, and where the product's odometry was in it: what all
/// runs share.
struct RecordedDrive {
  odometry::OdometryConfig config;
  inertial::Alignment start;
  std::vector<scan::DeskewedScan> scans;  // deskewed with the state that the product had
  std::vector<geometry::Se3>
      T_odom_imu;  // at each scan's end, by the product, undisturbed: the reference
  std::vector<sensor::ImuSample> imu;
  simulate::InertialErrors imu_errors;
  double imu_rate_hz = 0.0;
  double ape_rmse_m = 0.0;  // of the reference against the simulator's truth
};

/// Simulates a drive and maps it with the product's odometry, LiDAR and inertial sensor only;
/// writes no file. `overrides` are "key=value" of slamd's configuration.
RecordedDrive record(const simulate::Drive& drive, std::vector<std::string> overrides);

}  // namespace slamd::study
