#pragma once

#include <cstdint>
#include <optional>

#include "drivers/livox/conversation.hpp"
#include "drivers/livox/sdk2_frame.hpp"

namespace slamd::livox {

/// What one device is to do for this host; the ports are the SDK's for a Mid-360.
struct Sdk2HostConfig {
  DeviceCode serial_number;  // empty: the first that answers
  HostInterfaces interfaces;
  std::uint16_t command_port = 56101;  // where the host hears answers
  std::uint16_t state_port = 56201;
  std::uint16_t point_port = 56301;
  std::uint16_t imu_port = 56401;
  std::uint8_t point_type = 1;  // 1 of 32 bits, 2 of 16 bits, 3 spherical
  std::optional<std::uint8_t> scan_pattern;
  bool imu = true;
  /// Whether to take a device that is set to send to another host. They come so from the factory.
  bool take_over = true;
};

/// What is asked of a device before it is set, and once a second afterwards. A restart explains whatever else has changed:
/// it comes first.
inline constexpr Sdk2Key kSdk2ReadKeys[] = {Sdk2Key::kFirmware, Sdk2Key::kAttitude, Sdk2Key::kPointDestination,
                                            Sdk2Key::kWorkState, Sdk2Key::kPowerUps};
inline constexpr Sdk2Key kSdk2StateKeys[] = {Sdk2Key::kPowerUps, Sdk2Key::kWorkState,   Sdk2Key::kPointDestination,
                                             Sdk2Key::kSyncType, Sdk2Key::kTemperature, Sdk2Key::kHealth};

/// What is set in a device, in this order.
enum class Sdk2Step : std::uint8_t { kDestinations, kPointType, kScanPattern, kImu, kPointSend, kWorkMode, kDone };

/// Returns the step after this one.
Sdk2Step after(Sdk2Step step);

/// Returns the first step from this one on that the configuration wants.
Sdk2Step wanted_from(Sdk2Step step, const Sdk2HostConfig& config);

/// Tells whether there are no data without this step.
bool is_needed(Sdk2Step step);

/// The values that a step sets, for a host of this address. Not for kDone.
Sdk2ValueWriter values_of(Sdk2Step step, const Sdk2HostConfig& config, std::uint32_t host_address, std::uint8_t work_mode);

/// Says in words what a step wants done.
const char* words_of(Sdk2Step step);

}  // namespace slamd::livox
