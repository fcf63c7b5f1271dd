#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/configuration/configuration.hpp"

namespace slamd::replay {

/// A recording, and what is to be done with it.
struct Recording {
  std::filesystem::path name;     // as the user wrote it
  std::filesystem::path lidar;    // pcap file, or folder of clouds
  std::filesystem::path imu_csv;  // empty: none, or built in
  std::filesystem::path wheel_csv;  // empty: none
  std::filesystem::path gnss;       // CSV or a receiver's bytes; empty: none
  std::filesystem::path imu_can;    // candump log with the inertial sensor's frames; empty: none
  std::filesystem::path wheel_can;  // likewise, of the wheels
  std::filesystem::path truth;    // empty: none
  configuration::Configuration configuration;
};

/// Opens a recording: a directory with recording.toml, or a bare capture with configuration files.
/// The recording's own table comes first, then `config_files`, then `overrides` ("key=value").
/// Errors: ConfigurationError; RecordingError when something is missing.
Recording open_recording(const std::filesystem::path& path,
                         const std::vector<std::string>& config_files,
                         const std::vector<std::string>& overrides);

}  // namespace slamd::replay
