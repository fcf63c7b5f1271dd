#include "daemon/configuration/device.hpp"

#include <algorithm>
#include <cctype>

#include "daemon/configuration/configuration.hpp"

namespace slamd::configuration {

std::optional<DeviceFault> device_fault(const LidarConfiguration& lidar) {
  const DeviceConfiguration& device = lidar.device;
  const bool mid360 = lidar.model == LidarModel::kLivoxMid360;
  if (device.set_utc && (!device.is_kept() || lidar.model != LidarModel::kLivoxAvia)) {
    return DeviceFault{"lidar.device.set_utc", "true", "is for a Livox Avia that slamd keeps; see lidar.device.code"};
  }
  if (!device.is_kept()) {
    return std::nullopt;
  }
  const std::string code = '"' + device.code + '"';
  if (!is_livox(lidar.model)) {
    return DeviceFault{"lidar.device.code", code, "slamd talks to Livox devices only; lidar.model is none"};
  }
  const auto alphanumeric = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  if (device.code.size() > 16 || !std::all_of(device.code.begin(), device.code.end(), alphanumeric)) {
    return DeviceFault{"lidar.device.code", code,
                       "must be \"any\", or up to 16 letters and digits: an Avia's broadcast code, a Mid-360's serial number"};
  }
  if (mid360 && device.returns != DeviceReturns::kUnchanged) {
    return DeviceFault{"lidar.device.returns", "", "a Mid-360 has no return modes; must be \"unchanged\""};
  }
  const int ports[] = {lidar.command_port(), lidar.listening_port(), mid360 ? lidar.imu_port : 0,
                       mid360 ? device.state_port : 0};
  const bool inertial_beside_points = mid360 && ports[1] == ports[2];  // they may share one
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      if (ports[i] == ports[j] && ports[i] != 0 && !(i == 1 && j == 2 && inertial_beside_points)) {
        return DeviceFault{j == 3 ? "lidar.device.state_port" : "lidar.device.command_port",
                           std::to_string(j == 3 ? device.state_port : ports[0]), "is another port of the device's"};
      }
    }
  }
  return std::nullopt;
}

}  // namespace slamd::configuration
