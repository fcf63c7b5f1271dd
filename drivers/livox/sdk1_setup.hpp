#pragma once

#include <cstdint>
#include <optional>

#include "drivers/livox/conversation.hpp"
#include "drivers/livox/sdk1_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"

namespace slamd::livox {

enum class Sdk1Mode : std::uint8_t { kNormal = 1, kPowerSaving = 2, kStandby = 3 };

/// What one device is to do for this host.
struct Sdk1HostConfig {
  DeviceCode device;  // empty: the first that looks for a host
  HostInterfaces interfaces;
  std::uint16_t command_port = 55501;
  std::uint16_t data_port = 56001;
  std::uint16_t imu_port = 56001;
  std::uint8_t coordinate = 0;  // 0 cartesian, 1 spherical
  std::optional<std::uint8_t> return_mode;  // 0 first, 1 strongest, 2 dual, 3 triple; none: as it is
  bool imu = true;
  bool read_extrinsic = true;
};

/// What is done to a device before it samples, in this order.
enum class Sdk1Step : std::uint8_t { kDeviceInfo, kCoordinate, kReturnMode, kImuRate, kExtrinsic, kStart, kDone };

/// Returns the step after this one.
Sdk1Step after(Sdk1Step step);

/// Returns the first step from this one on that the configuration wants.
Sdk1Step wanted_from(Sdk1Step step, const Sdk1HostConfig& config);

/// The command of a step, and what it carries. Not for kDone.
Sdk1Command command_of(Sdk1Step step);
Payload payload_of(Sdk1Step step, const Sdk1HostConfig& config);

/// Says in words what a command wants done.
const char* words_of(Sdk1Command command);

}  // namespace slamd::livox
