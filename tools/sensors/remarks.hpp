#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/configuration/configuration.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// Something that a user should know of a sensor, in words.
struct Remark {
  std::string about;  // the sensor, port or line
  std::string words;
};

/// So far may gravity be from where the extrinsic has it: a vehicle need not stand quite level.
inline constexpr double kGravityTolerance_deg = 10.0;

/// Says in words what is wrong, or missing. A configuration, where one is given, tells where the inertial sensor sits.
std::vector<Remark> remarks_of(const Seen& seen, const std::optional<configuration::Configuration>& configuration);

/// Names a LiDAR: "Livox Avia 3JEDK380010Z391 at 192.168.1.12".
std::string name_of(const LidarSeen& lidar);

/// Names what speaks on a serial line.
const char* name_of(Tongue tongue);

/// Tells whether this host reaches an address directly: it lies in a subnet of one of the interfaces.
bool is_in_own_subnet(std::uint32_t address, const std::vector<transport::Interface>& interfaces);

/// The subnets of this host's interfaces, but for loopback: "10.0.0.5/24, 192.168.1.5/24".
std::string subnets_in_words(const std::vector<transport::Interface>& interfaces);

}  // namespace slamd::sensors
