#pragma once

#include <optional>
#include <string>

namespace slamd::configuration {

struct LidarConfiguration;

enum class DeviceCoordinates { kCartesian, kSpherical };
enum class DeviceReturns { kUnchanged, kFirst, kStrongest, kDual, kTriple };

/// How a Livox is to be set. Live, slamd then talks to the device itself: finds it, sets it and starts it.
struct DeviceConfiguration {
  std::string code;  // of the device, or "any": the first that is found; empty: somebody else has it send here
  DeviceCoordinates coordinates = DeviceCoordinates::kCartesian;
  DeviceReturns returns = DeviceReturns::kUnchanged;
  bool take_over = true;  // a Mid-360 that is set to send to another host
  bool set_utc = false;   // an SDK1 device with PPS is told each second's UTC
  int command_port = 0;   // of this host; 0: the SDK's
  int state_port = 56201;

  bool is_kept() const { return !code.empty(); }
};

/// What is wrong with a device's configuration, beyond what each key can tell.
struct DeviceFault {
  const char* path = "";
  std::string value;
  const char* why = "";
};

/// Finds the first fault, if there is one.
std::optional<DeviceFault> device_fault(const LidarConfiguration& lidar);

}  // namespace slamd::configuration
