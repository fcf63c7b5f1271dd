#include "tools/replay/recording.hpp"

#include "daemon/configuration/loader.hpp"
#include "drivers/recording/packet.hpp"

namespace slamd::replay {

using configuration::ConfigurationError;
using configuration::LidarModel;
using recording::RecordingError;

namespace {

namespace fs = std::filesystem;

/// The only capture of a directory, for recordings that do not name theirs.
fs::path only_capture(const fs::path& directory) {
  fs::path found;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
    const fs::path extension = entry.path().extension();
    if (extension == ".pcap" || extension == ".pcapng") {
      if (!found.empty()) {
        throw RecordingError(directory, "holds several captures; name one with lidar.source");
      }
      found = entry.path();
    }
  }
  if (found.empty()) {
    throw RecordingError(directory, "holds no capture (*.pcap, *.pcapng)");
  }
  return found;
}

fs::path existing(const fs::path& directory, const std::string& source, const char* key) {
  const fs::path file = directory / source;
  if (!fs::exists(file)) {
    throw RecordingError(file, std::string("does not exist (") + key + ")");
  }
  return file;
}

/// The candump log that takes the place of a live bus.
fs::path can_log(const fs::path& directory, const std::string& source, const char* key) {
  return existing(directory, source == "can" ? "can.log" : source, key);
}

/// The samples that a recording keeps in a file of their own; none where they are built in.
fs::path imu_file(const fs::path& directory, const configuration::ImuConfiguration& imu) {
  if (!imu.enabled || imu.source == "livox") {
    return {};
  }
  if (!imu.is_live_port()) {
    return existing(directory, imu.source.empty() ? "imu.csv" : imu.source, "imu.source");
  }
  if (!fs::exists(directory / "imu.csv")) {  // what came in at the port of a live daemon is recorded there
    throw RecordingError(directory / "imu.csv", "does not exist, and imu.source = \"" + imu.source +
                                                    "\" is for the live daemon; name the recording's file, or \"livox\"");
  }
  return directory / "imu.csv";
}

/// What came in at a live daemon's port is recorded as gnss.csv, where it is. A file that is only counted may be missing.
fs::path gnss_file(const fs::path& directory, const configuration::GnssConfiguration& gnss) {
  if (gnss.source.empty() || gnss.is_velodyne()) {
    return {};
  }
  if (!gnss.is_serial() && (gnss.use || fs::exists(directory / gnss.source))) {
    return existing(directory, gnss.source, "gnss.source");
  }
  return gnss.is_serial() && fs::exists(directory / "gnss.csv") ? directory / "gnss.csv" : fs::path();
}

}  // namespace

Recording open_recording(const fs::path& path,
                         const std::vector<std::string>& config_files,
                         const std::vector<std::string>& overrides) {
  if (!fs::exists(path)) {
    throw RecordingError(path, "does not exist");
  }
  const bool is_directory = fs::is_directory(path);
  configuration::Loader loader;
  if (is_directory && fs::exists(path / "recording.toml")) {
    loader.add_file(path / "recording.toml");
  } else if (config_files.empty()) {
    throw ConfigurationError(path.string() + ": has no recording.toml; say what the sensor is with --config FILE");
  }
  for (const std::string& file : config_files) {
    loader.add_file(file);
  }
  for (const std::string& key_value : overrides) {
    loader.add_override(key_value);
  }
  Recording recording;
  recording.name = path;
  recording.configuration = loader.load();
  const auto& lidar = recording.configuration.lidar;
  const auto& imu = recording.configuration.imu;
  const fs::path directory = is_directory ? path : path.parent_path();
  if (!is_directory) {
    recording.lidar = path;
  } else if (!lidar.source.empty()) {
    recording.lidar = existing(path, lidar.source, "lidar.source");
  } else {
    recording.lidar = lidar.model == LidarModel::kPoints ? path : only_capture(path);
  }
  if (imu.enabled && imu.is_on_can()) {
    recording.imu_can = can_log(directory, imu.source, "imu.source");
  } else {
    recording.imu_csv = imu_file(directory, imu);
  }
  if (const auto& wheel = recording.configuration.wheel; wheel.use && wheel.is_on_can()) {
    recording.wheel_can = can_log(directory, wheel.source, "wheel.source");
  } else if (wheel.use && !wheel.source.empty()) {
    recording.wheel_csv = existing(directory, wheel.source, "wheel.source");
  }
  recording.gnss = gnss_file(directory, recording.configuration.gnss);
  if (is_directory && fs::exists(path / "truth.tum")) {
    recording.truth = path / "truth.tum";
  }
  return recording;
}

}  // namespace slamd::replay
