#pragma once

#include <string>
#include <vector>

#include "core/calibration/agreement.hpp"
#include "core/geometry/se3.hpp"

namespace slamd::calibration {

/// Writes a value to tenths, never as "-0.0".
std::string in_tenths(double value);

/// Writes roll, pitch and yaw as the configuration's rpy_deg has them: "[0.0, 3.0, 0.0]". Units: degrees.
std::string rpy_in_words(const Eigen::Vector3d& rpy_deg);

/// Says what a drive has shown to be wrong, a line each with what to set instead; nothing where all agrees. Proposals are
/// for a person to take over: slamd applies none.
/// `offset_s` and T_base_imu are what the configuration has now. Not for real-time threads.
std::vector<std::string> complaints(const SensorAgreement& agreement, double offset_s, const geometry::Se3& T_base_imu);

/// Says what is known of the offset: "inertial stamps 0.3 ms late (1σ 0.4 ms)", or that it is not known.
std::string offset_in_words(const LidarImuAgreement& agreement);

}  // namespace slamd::calibration
