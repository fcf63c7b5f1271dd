#pragma once

#include <string>
#include <vector>

#include "tools/cli/command.hpp"
#include "tools/simulate/drive.hpp"
#include "tools/simulate/fault_options.hpp"
#include "tools/simulate/live_device.hpp"
#include "tools/simulate/live_drive.hpp"

namespace slamd::simulate {

/// What the command line of a simulation says.
struct Options {
  Drive drive;
  std::string out;
  std::string preview;
  bool force = false;
  bool replay = false;
  std::string lidar = "vlp16";
  std::string vehicle = "ackermann";
  std::string returns;
  std::string pattern;
  std::string coordinates;
  std::string waypoints;
  std::string mesh;
  std::string can;
  double turn_rate_degps = 120.0;
  double range_noise_m = -1.0;
  double beam_bias_m = -1.0;
  bool perfect_imu = false;
  bool covered = false;
  FaultOptions faults;
  std::string drive_to;  // --drive
  bool live = false;
  std::string device_code;
  bool pps = false;
  std::vector<double> device_extrinsic;
  std::string imu_to;
  std::string gnss_to;
  std::string can_to;
  std::string lcm_url;
  std::string lcm_prefix;
  bool json = false;
};

/// Declares the options of a simulation.
void declare(const cli::Command& app, Options& options);

/// Returns the drive that the options describe. Errors: cli::UsageError, RecordingError.
Drive drive_of(const Options& options);

/// Returns what the device of a live drive is.
DeviceOptions device_options_of(const Options& options);

/// Returns where a live drive goes. Errors: cli::UsageError.
LiveOptions live_options_of(const Options& options);

}  // namespace slamd::simulate
