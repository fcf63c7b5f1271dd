#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace slamd::sensors {

/// Finds the serial adapters that are plugged in: below `dev`, the links of serial/by-id, which stay the same whatever
/// is plugged in first, and ttyUSB* and ttyACM* that have none. A board's own lines (ttyS*, ttyAMA*, ttyTHS*) are left
/// alone: there is a console on some of them.
std::vector<std::string> serial_adapters(const std::filesystem::path& dev = "/dev");

/// Tells whether two names lead to the same device: there may be links to it.
bool is_same_device(const std::string& a, const std::string& b);

/// Finds the CAN interfaces, as the kernel shows them below `net`.
std::vector<std::string> can_interfaces(const std::filesystem::path& net = "/sys/class/net");

}  // namespace slamd::sensors
