#pragma once

#include <cstdint>

namespace slamd::imu {

/// What an inertial sensor on a serial line speaks, or on a CAN bus (kXsens, kAceinna).
enum class Protocol : std::uint8_t { kCsv, kXsens, kMip, kAceinna };

/// Names a protocol as configured.
const char* name_of(Protocol protocol);

}  // namespace slamd::imu
